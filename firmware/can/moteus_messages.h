#pragma once

#include <cstdint>
#include <vector>

#include "firmware/can/frame.h"
#include "firmware/can/joint_drive_config.h"
#include "firmware/can/signal.h"

namespace armada::moteus {

/// Frames between a moteus controller and its master, for both sides of the bus: CAN FD with bit-rate switch,
/// sequences of subframes that write and read numbered registers, little-endian, turns and N m at the
/// moteus's output. Only the few fixed layouts that the master uses; the emulated controller reads any.
/// Sources: moteus documentation, docs/protocol/can.md and registers.md; mjlib multiplex/micro_server.cc.
///
/// Identifier: source << 8 | destination, bit 15 asks for an answer; more than 11 bits make it extended.

enum class Register : uint32_t {
  kMode = 0x000,
  kPosition = 0x001,
  kVelocity = 0x002,
  kTorque = 0x003,
  kVoltage = 0x00D,
  kTemperature = 0x00E,
  kFault = 0x00F,
  kCommandPosition = 0x020,
  kCommandVelocity = 0x021,
  kCommandTorque = 0x022,
  kCommandKpScale = 0x023,
  kCommandKdScale = 0x024,
  kCommandMaxTorque = 0x025,
  kCommandStopPosition = 0x026,
  kCommandTimeout = 0x027,
  kRegisterMapVersion = 0x102,
};

enum class Mode : int8_t {
  kStopped = 0,
  kFault = 1,
  kEnabling = 2,
  kCalibrating = 3,
  kCalibrationComplete = 4,
  kPosition = 10,
  kPositionTimeout = 11,  ///< the watchdog has tripped; until a stop
};

/// What a byte of padding is: a subframe that does nothing.
constexpr uint8_t kNop = 0x50;
/// Version of the register map that all this is true of.
constexpr int32_t kRegisterMap = 5;

struct State {
  Mode mode = Mode::kStopped;
  float position_turns = 0.0f;
  float velocity_turns_s = 0.0f;
  float torque_Nm = 0.0f;
  uint8_t fault = 0;  ///< of a mode other than kFault: what limits the power, 96 and up
};

/// Asked for during the bring-up.
struct Setup {
  State state;
  float watchdog_s = 0.0f;
  int32_t register_map = 0;
};

/// "motor driver fault"; "unknown" for codes that the manual does not list.
const char* FaultName(uint32_t fault);

constexpr uint32_t RequestId(int source, int node, bool answer) {
  return (answer ? 0x8000u : 0u) | static_cast<uint32_t>(source) << 8 | static_cast<uint32_t>(node);
}
constexpr uint32_t AnswerId(int source, int node) {
  return static_cast<uint32_t>(node) << 8 | static_cast<uint32_t>(source);
}

/// An empty FD frame with bit-rate switch.
CanFrame EmptyFrame(uint32_t id);
/// Fills the frame with padding up to a length that CAN FD has.
void Pad(CanFrame* frame);

/// Mode stopped: clears faults and the time-out. Not answered.
CanFrame EncodeStop(const JointDriveConfig& joint);
/// Position mode with nothing but a feed-forward torque, valid for the joint's watchdog_s. Not answered.
CanFrame EncodeTorque(const JointDriveConfig& joint, float torque_Nm);
CanFrame EncodeStateQuery(const JointDriveConfig& joint);
CanFrame EncodeSetupQuery(const JointDriveConfig& joint);

/// By its identifier.
bool IsFromDrive(const CanFrame& frame, const JointDriveConfig& joint);
/// False, and the result left alone, unless the frame is the answer to that query and every number in it is
/// finite. @pre IsFromDrive
bool DecodeState(const CanFrame& frame, State* state);
bool DecodeSetup(const CanFrame& frame, Setup* setup);

/// All messages between the joint's drive and its master. Where two share an identifier, the first that fits
/// is meant.
std::vector<CanMessage> Messages(const JointDriveConfig& joint);

}  // namespace armada::moteus
