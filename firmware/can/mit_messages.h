#pragma once

#include <cstdint>
#include <vector>

#include "firmware/can/frame.h"
#include "firmware/can/joint_drive_config.h"
#include "firmware/can/signal.h"

namespace armada::mit {

/// Messages of the packed-frame protocol of the MIT mini-cheetah and its kin, for both sides of the bus:
/// classic frames with 11-bit identifiers, big-endian bit fields, motor side. A field of b bits holds the
/// range -max to max (gains: 0 to max) in 2^b - 1 steps; the ranges are the joint's MitConfig and do not
/// show on the wire. Sources: mini-cheetah firmware (bgkatz/motorcontrol, Core/Src/can.c and
/// stm32f4xx_it.c), CubeMars AK Series Actuator Driver Manual 1.0.8, 5.3, Damiao's manuals.
///
/// Commands go to the drive's node_id; every one is answered with the drive's state, on `master_id`, which
/// the drives of an arm may share: byte 0 tells them apart.

/// Last byte of the frames FF FF FF FF FF FF FF xx, which are no commands.
enum class Special : uint8_t {
  kClearFault = 0xFB,  ///< Damiao only
  kEnable = 0xFC,
  kDisable = 0xFD,
  kSetZero = 0xFE,
};

struct Command {
  double position_rad = 0.0;
  double velocity_rad_s = 0.0;
  double kp_Nm_rad = 0.0;
  double kd_Nms_rad = 0.0;
  double torque_Nm = 0.0;
};

struct Reply {
  double position_rad = 0.0;
  double velocity_rad_s = 0.0;
  double torque_Nm = 0.0;
  /// Damiao: 0 disabled, 1 enabled, others are faults. CubeMars: error code, 0 none. mini-cheetah: always 0.
  uint8_t status = 0;
};

/// What everyone sends for zero torque. 4096 codes are symmetric about 2047.5: it is half a step off.
constexpr uint32_t kZeroTorqueCode = 0x7FF;
/// Positions within this many codes of an end of their range are not to be trusted: the drives do not stop
/// at the end, they go on at the other.
constexpr uint32_t kPositionMargin = 0x100;
/// A Damiao drive's reply has four bits for its node.
constexpr int kMaxDamiaoNode = 15;

/// Difference between neighbouring torque codes, motor side.
double TorqueStep_Nm(const MitConfig& config);

/// Code nearest to `tau_Nm` of those that do not exceed `limit_Nm` in magnitude; halfway, the lower, so that
/// 0 is kZeroTorqueCode, which is also the answer when the limit is below half a step. Motor side.
uint32_t TorqueCode(const MitConfig& config, double tau_Nm, double limit_Nm);

/// Torque only: position and velocity mid-range, both gains 0.
CanFrame EncodeTorque(const JointDriveConfig& joint, uint32_t torque_code);
CanFrame EncodeSpecial(const JointDriveConfig& joint, Special special);
/// As the drives do it: truncated, and out of range it goes on at the other end.
CanFrame EncodeReply(const JointDriveConfig& joint, const Reply& reply);

/// A frame for the drive, by its identifier, 8 bytes long.
bool IsForDrive(const CanFrame& frame, const JointDriveConfig& joint);
/// @pre IsForDrive. False for any other frame than FF .. FF xx, xx >= FB.
bool DecodeSpecial(const CanFrame& frame, Special* special);
/// @pre IsForDrive, not special.
Command DecodeCommand(const CanFrame& frame, const JointDriveConfig& joint);

/// A frame of the drive, by its identifier and byte 0.
bool IsFromDrive(const CanFrame& frame, const JointDriveConfig& joint);
/// False, and `reply` left alone, unless the length is the profile's.
/// @pre IsFromDrive
bool DecodeReply(const CanFrame& frame, const JointDriveConfig& joint, Reply* reply);
/// 16 bits. @pre DecodeReply was true
uint32_t PositionCode(const CanFrame& frame);

/// All messages between the joint's drive and its master. Where two share an identifier, the first that fits
/// is meant: special frames come before the command, register replies before the state.
std::vector<CanMessage> Messages(const JointDriveConfig& joint);

}  // namespace armada::mit
