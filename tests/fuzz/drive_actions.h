#pragma once

#include <cstdint>

#include "firmware/can/joint_drive_config.h"
#include "hil/emulated_drive.h"

namespace armada {

/// The language of the inputs of the drive fuzzers: one byte of options, then actions. An action is a byte,
/// taken modulo kActions, and its arguments.
enum class DriveAction : uint8_t {
  kMessage,     ///< u8 message of the joint's table, u8 length (0: the message's), bytes: on the bus
  kFrame,       ///< u8 flags, u32 identifier, u8 length, bytes: on the bus
  kReplay,      ///< u8 which of the last frames, u8 byte, u8 bits to invert: on the bus
  kBringUp,     ///< u8 ticks of the master's bring-up
  kTorque,      ///< torque (see ReadTorque): a tick with a sample request and a torque
  kQuickStop,   ///< master
  kDisable,     ///< master
  kReset,       ///< master
  kTime,        ///< u8: passes, up to 0.65 s
  kMove,        ///< i16 position [0.01 rad], i16 velocity [0.1 rad/s]: of the joint
  kLose,        ///< u8: a bit each for the next eight frames, set: lost
  kPowerCycle,  ///< a new emulated drive
  kRecover,     ///< reset, new drive, undisturbed bring-up
};
inline constexpr unsigned kActions = 13;

struct DriveSetup {
  JointDriveConfig joint;
  EmulatedDriveConfig drive;
};

/// The joint that the byte of options means.
inline DriveSetup SetupOf(DriveProfile profile, uint8_t options) {
  DriveSetup setup;
  JointDriveConfig& joint = setup.joint;
  joint.profile = profile;
  joint.node_id = 5;
  joint.mit.master_id = 0x11;
  joint.gear_ratio = (options & 1) != 0 ? 9.1 : 1.0;
  joint.direction = (options & 2) != 0 ? -1.0 : 1.0;
  joint.offset_rad = (options & 4) != 0 ? 0.5 : 0.0;
  joint.torque_limit_Nm = (options & 8) != 0 ? 7.3 : 60.0;
  joint.cia402.torque_of_max = (options & 16) != 0;
  setup.drive.encoder_counts_per_turn = (options & 32) != 0 ? 16384.0 : 0.0;
  setup.drive.velocity_noise_rad_s = (options & 64) != 0 ? 0.01 : 0.0;
  setup.drive.feedback_period_s = (options & 128) != 0 ? 0.01 : 0.0;
  return setup;
}

}  // namespace armada
