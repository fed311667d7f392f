#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "firmware/can/frame.h"
#include "firmware/can/joint_drive_config.h"
#include "firmware/can/signal.h"

namespace armada::odrive {

/// Messages of the ODrive CANSimple protocol, for both sides of the bus: classic frames with 11-bit
/// identifier node << 5 | command, little-endian fields, in the drive's units: motor turns and motor-side N
/// m. https://docs.odriverobotics.com/v/latest/manual/can-protocol.html, for 0.5: /v/0.5.6/can-protocol.html
///
/// Encoders want node <= 63. Decoders return false, and leave their result alone, unless the frame is the
/// node's message of that name, is as long as its fields, and every number in it is finite.

enum class Command : uint8_t {
  kGetVersion = 0x00,  ///< 0.6 only
  kHeartbeat = 0x01,
  kEstop = 0x02,
  kSetAxisState = 0x07,
  kEncoderEstimates = 0x09,
  kSetControllerMode = 0x0B,
  kSetInputTorque = 0x0E,
  kClearErrors = 0x18,
};

/// Generations of firmware that differ in what a heartbeat and its error bits mean.
enum class Firmware {
  kV05,  ///< 0.5.x, ODrive 3.x
  kV06,  ///< 0.6.x, ODrive Pro, S1, Micro
};

constexpr Firmware FirmwareOf(DriveProfile profile) {
  return profile == DriveProfile::kODriveCanSimpleV05 ? Firmware::kV05 : Firmware::kV06;
}

enum class AxisState : uint8_t { kUndefined = 0, kIdle = 1, kClosedLoop = 8 };
enum class ControlMode : uint32_t { kVoltage = 0, kTorque = 1, kVelocity = 2, kPosition = 3 };
enum class InputMode : uint32_t { kInactive = 0, kPassthrough = 1 };

struct Heartbeat {
  uint32_t error =
      0;  ///< axis errors; 0.5's motor, encoder and controller flags come as their axis error bits
  AxisState state = AxisState::kUndefined;
  uint8_t procedure_result = 0;  ///< 0.6 only: 0 success, 1 busy, 3 disarmed, ...
};

struct EncoderEstimates {
  float position_turns = 0.0f;
  float velocity_turns_s = 0.0f;
};

struct ControllerMode {
  ControlMode control = ControlMode::kPosition;
  InputMode input = InputMode::kPassthrough;
};

struct Version {
  uint8_t protocol = 0;
  std::array<uint8_t, 3> hardware{};  ///< product line, version, variant
  std::array<uint8_t, 3> firmware{};  ///< major, minor, revision
  bool unreleased = false;
};

/// Axis error bits used here.
constexpr uint32_t WatchdogError(Firmware firmware) {
  return firmware == Firmware::kV05 ? 0x800 : 0x100'0000;
}
constexpr uint32_t EstopError(Firmware firmware) {
  return firmware == Firmware::kV05 ? 0x4000 : 0x200'0000;
}

/// True for a classic frame with an 11-bit identifier of this node, data or remote; `command` is its low five
/// bits.
bool IsForNode(const CanFrame& frame, int node, Command* command);

CanFrame EncodeVersionRequest(int node);  ///< remote frame: asks for the version
CanFrame EncodeVersion(int node, const Version& version);
CanFrame EncodeHeartbeat(int node, Firmware firmware, const Heartbeat& heartbeat);
CanFrame EncodeEstop(int node);
CanFrame EncodeSetAxisState(int node, AxisState state);
CanFrame EncodeEncoderEstimates(int node, const EncoderEstimates& estimates);
CanFrame EncodeEncoderRequest(int node);  ///< remote frame: asks for the estimates
CanFrame EncodeSetControllerMode(int node, const ControllerMode& mode);
CanFrame EncodeSetInputTorque(int node, float torque_Nm);
CanFrame EncodeClearErrors(int node);

bool DecodeVersion(const CanFrame& frame, int node, Version* version);
bool DecodeHeartbeat(const CanFrame& frame, int node, Firmware firmware, Heartbeat* heartbeat);
bool DecodeSetAxisState(const CanFrame& frame, int node, AxisState* state);
bool DecodeEncoderEstimates(const CanFrame& frame, int node, EncoderEstimates* estimates);
bool DecodeSetControllerMode(const CanFrame& frame, int node, ControllerMode* mode);
bool DecodeSetInputTorque(const CanFrame& frame, int node, float* torque_Nm);

/// All of the above for one joint, field by field.
std::vector<CanMessage> Messages(const JointDriveConfig& joint);

}  // namespace armada::odrive
