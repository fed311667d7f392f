#include "hil/cia402_emulator.h"
#include "hil/mit_emulator.h"
#include "hil/moteus_emulator.h"
#include "hil/odrive_emulator.h"

namespace armada {

std::unique_ptr<EmulatedDrive> MakeEmulatedDrive(const JointDriveConfig& joint,
                                                 const EmulatedDriveConfig& config, uint64_t seed) {
  switch (joint.profile) {
    case DriveProfile::kODriveCanSimple:
    case DriveProfile::kODriveCanSimpleV05:
      return std::make_unique<ODriveEmulator>(joint, config, seed);
    case DriveProfile::kMiniCheetah:
    case DriveProfile::kCubeMars:
    case DriveProfile::kDamiao:
      return std::make_unique<MitEmulator>(joint, config, seed);
    case DriveProfile::kMoteus:
      return std::make_unique<MoteusEmulator>(joint, config, seed);
    case DriveProfile::kCia402:
      return std::make_unique<Cia402Emulator>(joint, config, seed);
  }
  return nullptr;
}

}  // namespace armada
