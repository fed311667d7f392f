#include "firmware/can/odrive_messages.h"

#include <bit>
#include <cmath>
#include <utility>

namespace armada::odrive {
namespace {

constexpr int kCommandBits = 5;
constexpr uint32_t kCommandMask = (1u << kCommandBits) - 1;

CanFrame Frame(int node, Command command, uint8_t length) {
  CanFrame frame;
  frame.id = static_cast<uint32_t>(node) << kCommandBits | static_cast<uint32_t>(command);
  frame.length = length;
  return frame;
}

using enum CanSignal::Kind;
constexpr auto kLittle = CanSignal::ByteOrder::kLittle;

constexpr CanSignal kAxisError{"axis_error", 0, 32};
constexpr CanSignal kAxisState{"axis_state", 32, 8};
constexpr CanSignal kProcedureResult{"procedure_result", 40, 8};
constexpr CanSignal kRequestedState{"requested_state", 0, 32};
constexpr CanSignal kPosition{"position", 0, 32, kFloat32, kLittle, "rev"};
constexpr CanSignal kVelocity{"velocity", 32, 32, kFloat32, kLittle, "rev/s"};
constexpr CanSignal kControlMode{"control_mode", 0, 32};
constexpr CanSignal kInputMode{"input_mode", 32, 32};
constexpr CanSignal kInputTorque{"input_torque", 0, 32, kFloat32, kLittle, "N m"};
constexpr CanSignal kIdentify{"identify", 0, 8};

// 0.5: a heartbeat flag says that a part of the axis failed; the axis error has a bit for the same.
struct PartFlag {
  CanSignal signal;
  uint32_t axis_error;
};
constexpr PartFlag kPartFlags[] = {
    {{"motor_error", 40, 1}, 0x40}, {{"encoder_error", 48, 1}, 0x100}, {{"controller_error", 56, 1}, 0x200}};
constexpr CanSignal kTrajectoryDone{"trajectory_done", 63, 1};

constexpr std::array<CanSignal, 8> kVersion = {{{"protocol_version", 0, 8},
                                                {"hardware_product_line", 8, 8},
                                                {"hardware_version", 16, 8},
                                                {"hardware_variant", 24, 8},
                                                {"firmware_major", 32, 8},
                                                {"firmware_minor", 40, 8},
                                                {"firmware_revision", 48, 8},
                                                {"firmware_unreleased", 56, 8}}};
constexpr size_t kHardwareVersion = 1;  // first of three, likewise:
constexpr size_t kFirmwareVersion = 4;

float GetFloat(const CanFrame& frame, const CanSignal& signal) {
  return std::bit_cast<float>(GetRaw(frame, signal));
}
void PutFloat(const CanSignal& signal, float value, CanFrame* frame) {
  PutRaw(signal, std::bit_cast<uint32_t>(value), frame);
}

bool IsData(const CanFrame& frame, int node, Command wanted, uint8_t length) {
  Command command{};
  return IsForNode(frame, node, &command) && command == wanted && !frame.remote && frame.length == length;
}

}  // namespace

bool IsForNode(const CanFrame& frame, int node, Command* command) {
  if (frame.extended || frame.error || frame.fd) return false;
  if (frame.id >> kCommandBits != static_cast<uint32_t>(node)) return false;
  *command = static_cast<Command>(frame.id & kCommandMask);
  return true;
}

CanFrame EncodeVersionRequest(int node) {
  CanFrame frame = Frame(node, Command::kGetVersion, 8);
  frame.remote = true;
  return frame;
}

CanFrame EncodeVersion(int node, const Version& version) {
  CanFrame frame = Frame(node, Command::kGetVersion, 8);
  PutRaw(kVersion[0], version.protocol, &frame);
  for (size_t i = 0; i < 3; ++i) {
    PutRaw(kVersion[kHardwareVersion + i], version.hardware[i], &frame);
    PutRaw(kVersion[kFirmwareVersion + i], version.firmware[i], &frame);
  }
  PutRaw(kVersion.back(), version.unreleased ? 1 : 0, &frame);
  return frame;
}

CanFrame EncodeHeartbeat(int node, Firmware firmware, const Heartbeat& heartbeat) {
  CanFrame frame = Frame(node, Command::kHeartbeat, 8);
  PutRaw(kAxisError, heartbeat.error, &frame);
  PutRaw(kAxisState, static_cast<uint32_t>(heartbeat.state), &frame);
  if (firmware == Firmware::kV06) {
    PutRaw(kProcedureResult, heartbeat.procedure_result, &frame);
  } else {
    for (const PartFlag& flag : kPartFlags) {
      PutRaw(flag.signal, (heartbeat.error & flag.axis_error) != 0 ? 1 : 0, &frame);
    }
  }
  return frame;
}

CanFrame EncodeEstop(int node) {
  return Frame(node, Command::kEstop, 0);
}

CanFrame EncodeSetAxisState(int node, AxisState state) {
  CanFrame frame = Frame(node, Command::kSetAxisState, 4);
  PutRaw(kRequestedState, static_cast<uint32_t>(state), &frame);
  return frame;
}

CanFrame EncodeEncoderEstimates(int node, const EncoderEstimates& estimates) {
  CanFrame frame = Frame(node, Command::kEncoderEstimates, 8);
  PutFloat(kPosition, estimates.position_turns, &frame);
  PutFloat(kVelocity, estimates.velocity_turns_s, &frame);
  return frame;
}

CanFrame EncodeEncoderRequest(int node) {
  CanFrame frame = Frame(node, Command::kEncoderEstimates, 8);
  frame.remote = true;
  return frame;
}

CanFrame EncodeSetControllerMode(int node, const ControllerMode& mode) {
  CanFrame frame = Frame(node, Command::kSetControllerMode, 8);
  PutRaw(kControlMode, static_cast<uint32_t>(mode.control), &frame);
  PutRaw(kInputMode, static_cast<uint32_t>(mode.input), &frame);
  return frame;
}

CanFrame EncodeSetInputTorque(int node, float torque_Nm) {
  CanFrame frame = Frame(node, Command::kSetInputTorque, 4);
  PutFloat(kInputTorque, torque_Nm, &frame);
  frame.latest_only = true;
  return frame;
}

/// 0.6 reads one byte, "identify" (flash the light); 0.5 reads none and takes it.
CanFrame EncodeClearErrors(int node) {
  return Frame(node, Command::kClearErrors, 1);
}

bool DecodeVersion(const CanFrame& frame, int node, Version* version) {
  if (!IsData(frame, node, Command::kGetVersion, 8)) return false;
  version->protocol = static_cast<uint8_t>(GetRaw(frame, kVersion[0]));
  for (size_t i = 0; i < 3; ++i) {
    version->hardware[i] = static_cast<uint8_t>(GetRaw(frame, kVersion[kHardwareVersion + i]));
    version->firmware[i] = static_cast<uint8_t>(GetRaw(frame, kVersion[kFirmwareVersion + i]));
  }
  version->unreleased = GetRaw(frame, kVersion.back()) != 0;
  return true;
}

bool DecodeHeartbeat(const CanFrame& frame, int node, Firmware firmware, Heartbeat* heartbeat) {
  if (!IsData(frame, node, Command::kHeartbeat, 8)) return false;
  heartbeat->error = GetRaw(frame, kAxisError);
  heartbeat->state = static_cast<AxisState>(GetRaw(frame, kAxisState));
  heartbeat->procedure_result = 0;
  if (firmware == Firmware::kV06) {
    heartbeat->procedure_result = static_cast<uint8_t>(GetRaw(frame, kProcedureResult));
  } else {
    for (const PartFlag& flag : kPartFlags) {
      if (GetRaw(frame, flag.signal) != 0) heartbeat->error |= flag.axis_error;
    }
  }
  return true;
}

bool DecodeSetAxisState(const CanFrame& frame, int node, AxisState* state) {
  if (!IsData(frame, node, Command::kSetAxisState, 4)) return false;
  const uint32_t value = GetRaw(frame, kRequestedState);
  if (value > UINT8_MAX) return false;
  *state = static_cast<AxisState>(value);
  return true;
}

bool DecodeEncoderEstimates(const CanFrame& frame, int node, EncoderEstimates* estimates) {
  if (!IsData(frame, node, Command::kEncoderEstimates, 8)) return false;
  const EncoderEstimates read{GetFloat(frame, kPosition), GetFloat(frame, kVelocity)};
  if (!std::isfinite(read.position_turns) || !std::isfinite(read.velocity_turns_s)) return false;
  *estimates = read;
  return true;
}

bool DecodeSetControllerMode(const CanFrame& frame, int node, ControllerMode* mode) {
  if (!IsData(frame, node, Command::kSetControllerMode, 8)) return false;
  mode->control = static_cast<ControlMode>(GetRaw(frame, kControlMode));
  mode->input = static_cast<InputMode>(GetRaw(frame, kInputMode));
  return true;
}

bool DecodeSetInputTorque(const CanFrame& frame, int node, float* torque_Nm) {
  if (!IsData(frame, node, Command::kSetInputTorque, 4)) return false;
  const float read = GetFloat(frame, kInputTorque);
  if (!std::isfinite(read)) return false;
  *torque_Nm = read;
  return true;
}

std::vector<CanMessage> Messages(const JointDriveConfig& joint) {
  std::vector<CanSignal> heartbeat = {kAxisError, kAxisState};
  if (FirmwareOf(joint.profile) == Firmware::kV06) {
    heartbeat.push_back(kProcedureResult);
  } else {
    for (const PartFlag& flag : kPartFlags) heartbeat.push_back(flag.signal);
    heartbeat.push_back(kTrajectoryDone);
  }
  const auto message = [&](const char* name, Command command, bool from_drive, uint8_t length,
                           std::vector<CanSignal> signals, const char* meaning) {
    return CanMessage{.name = name,
                      .id = Frame(joint.node_id, command, length).id,
                      .from_drive = from_drive,
                      .length = length,
                      .signals = std::move(signals),
                      .meaning = meaning};
  };
  std::vector<CanMessage> messages = {
      message("Heartbeat", Command::kHeartbeat, true, 8, std::move(heartbeat), "every 100 ms"),
      message("Estop", Command::kEstop, false, 0, {}, "disarms and latches an error"),
      message("SetAxisState", Command::kSetAxisState, false, 4, {kRequestedState}, "1 idle, 8 closed loop"),
      message("EncoderEstimates", Command::kEncoderEstimates, true, 8, {kPosition, kVelocity},
              "motor side; on request or cyclic"),
      message("SetControllerMode", Command::kSetControllerMode, false, 8, {kControlMode, kInputMode},
              "1 torque control, 1 passthrough"),
      message("SetInputTorque", Command::kSetInputTorque, false, 4, {kInputTorque}, "motor side"),
      message("ClearErrors", Command::kClearErrors, false, 1, {kIdentify},
              "as when the drive was switched on"),
  };
  if (FirmwareOf(joint.profile) == Firmware::kV06) {
    messages.push_back(message("Version", Command::kGetVersion, true, 8, {kVersion.begin(), kVersion.end()},
                               "on request; for tools"));
  }
  return messages;
}

}  // namespace armada::odrive
