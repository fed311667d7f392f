#pragma once

#include "firmware/core/named_enum.h"

namespace armada {

/// Drive families, and generations of them that differ on the wire.
enum class DriveProfile {
  kODriveCanSimple,     ///< ODrive firmware 0.6: Pro, S1, Micro
  kODriveCanSimpleV05,  ///< ODrive firmware 0.5, ODrive 3.x: another heartbeat
  kMiniCheetah,         ///< MIT packed frames, reply of 6 bytes, what follows ignored
  kCubeMars,            ///< CubeMars AK in MIT mode: the reply ends with temperature and error code
  kDamiao,              ///< MIT packed frames, reply with status and temperatures, parameters on 0x7FF
  kCia402,              ///< CANopen, CiA 402, cyclic synchronous torque
  kMoteus,              ///< moteus registers on CAN FD
};

constexpr auto EnumNames(DriveProfile) {
  using enum DriveProfile;
  return std::to_array<EnumName<DriveProfile>>({{kODriveCanSimple, "odrive_cansimple"},
                                                {kODriveCanSimpleV05, "odrive_cansimple_v05"},
                                                {kMiniCheetah, "mini_cheetah"},
                                                {kCubeMars, "cubemars"},
                                                {kDamiao, "damiao"},
                                                {kCia402, "cia402"},
                                                {kMoteus, "moteus"}});
}

/// Addresses that a drive of the profile can have.
struct NodeIdRange {
  int min;
  int max;
};

constexpr NodeIdRange NodeIdsOf(DriveProfile profile) {
  switch (profile) {
    case DriveProfile::kODriveCanSimple:
    case DriveProfile::kODriveCanSimpleV05:
      return {0, 63};
    case DriveProfile::kDamiao:
      return {1, 15};  // four bits of its reply
    case DriveProfile::kCia402:
      return {1, 127};
    case DriveProfile::kMoteus:
      return {1, 126};  // 127 addresses all
    case DriveProfile::kMiniCheetah:
    case DriveProfile::kCubeMars:
      break;
  }
  return {0, 127};
}

}  // namespace armada
