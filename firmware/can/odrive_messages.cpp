#include "firmware/can/odrive_messages.h"

#include <bit>
#include <cmath>

namespace armada::odrive {
namespace {

constexpr int kCommandBits = 5;
constexpr uint32_t kCommandMask = (1u << kCommandBits) - 1;

// 0.5: a heartbeat flag says that a part of the axis failed; the axis error has a bit for the same.
struct PartFlag {
  size_t byte;
  uint32_t axis_error;
};
constexpr PartFlag kPartFlags[] = {{5, 0x40}, {6, 0x100}, {7, 0x200}};  // motor, encoder, controller

CanFrame Frame(int node, Command command, uint8_t length) {
  CanFrame frame;
  frame.id = static_cast<uint32_t>(node) << kCommandBits | static_cast<uint32_t>(command);
  frame.length = length;
  return frame;
}

void PutU32(uint32_t value, size_t at, CanFrame* frame) {
  for (size_t i = 0; i < 4; ++i) frame->data[at + i] = static_cast<uint8_t>(value >> (8 * i));
}

uint32_t GetU32(const CanFrame& frame, size_t at) {
  uint32_t value = 0;
  for (size_t i = 4; i-- > 0;) value = value << 8 | frame.data[at + i];
  return value;
}

void PutF32(float value, size_t at, CanFrame* frame) {
  PutU32(std::bit_cast<uint32_t>(value), at, frame);
}
float GetF32(const CanFrame& frame, size_t at) {
  return std::bit_cast<float>(GetU32(frame, at));
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

CanFrame EncodeHeartbeat(int node, Firmware firmware, const Heartbeat& heartbeat) {
  CanFrame frame = Frame(node, Command::kHeartbeat, 8);
  PutU32(heartbeat.error, 0, &frame);
  frame.data[4] = static_cast<uint8_t>(heartbeat.state);
  if (firmware == Firmware::kV06) {
    frame.data[5] = heartbeat.procedure_result;
  } else {
    for (const PartFlag& flag : kPartFlags) frame.data[flag.byte] = (heartbeat.error & flag.axis_error) != 0;
  }
  return frame;
}

CanFrame EncodeEstop(int node) {
  return Frame(node, Command::kEstop, 0);
}

CanFrame EncodeSetAxisState(int node, AxisState state) {
  CanFrame frame = Frame(node, Command::kSetAxisState, 4);
  PutU32(static_cast<uint32_t>(state), 0, &frame);
  return frame;
}

CanFrame EncodeEncoderEstimates(int node, const EncoderEstimates& estimates) {
  CanFrame frame = Frame(node, Command::kEncoderEstimates, 8);
  PutF32(estimates.position_turns, 0, &frame);
  PutF32(estimates.velocity_turns_s, 4, &frame);
  return frame;
}

CanFrame EncodeEncoderRequest(int node) {
  CanFrame frame = Frame(node, Command::kEncoderEstimates, 8);
  frame.remote = true;
  return frame;
}

CanFrame EncodeSetControllerMode(int node, const ControllerMode& mode) {
  CanFrame frame = Frame(node, Command::kSetControllerMode, 8);
  PutU32(static_cast<uint32_t>(mode.control), 0, &frame);
  PutU32(static_cast<uint32_t>(mode.input), 4, &frame);
  return frame;
}

CanFrame EncodeSetInputTorque(int node, float torque_Nm) {
  CanFrame frame = Frame(node, Command::kSetInputTorque, 4);
  PutF32(torque_Nm, 0, &frame);
  return frame;
}

/// 0.6 reads one byte, "identify" (flash the light); 0.5 reads none and takes it.
CanFrame EncodeClearErrors(int node) {
  return Frame(node, Command::kClearErrors, 1);
}

bool DecodeHeartbeat(const CanFrame& frame, int node, Firmware firmware, Heartbeat* heartbeat) {
  if (!IsData(frame, node, Command::kHeartbeat, 8)) return false;
  heartbeat->error = GetU32(frame, 0);
  heartbeat->state = static_cast<AxisState>(frame.data[4]);
  heartbeat->procedure_result = 0;
  if (firmware == Firmware::kV06) {
    heartbeat->procedure_result = frame.data[5];
  } else {
    for (const PartFlag& flag : kPartFlags) {
      if (frame.data[flag.byte] & 1u)
        heartbeat->error |= flag.axis_error;  // bit 7 of the last: trajectory done
    }
  }
  return true;
}

bool DecodeSetAxisState(const CanFrame& frame, int node, AxisState* state) {
  if (!IsData(frame, node, Command::kSetAxisState, 4)) return false;
  const uint32_t value = GetU32(frame, 0);
  if (value > UINT8_MAX) return false;
  *state = static_cast<AxisState>(value);
  return true;
}

bool DecodeEncoderEstimates(const CanFrame& frame, int node, EncoderEstimates* estimates) {
  if (!IsData(frame, node, Command::kEncoderEstimates, 8)) return false;
  const EncoderEstimates read{GetF32(frame, 0), GetF32(frame, 4)};
  if (!std::isfinite(read.position_turns) || !std::isfinite(read.velocity_turns_s)) return false;
  *estimates = read;
  return true;
}

bool DecodeSetControllerMode(const CanFrame& frame, int node, ControllerMode* mode) {
  if (!IsData(frame, node, Command::kSetControllerMode, 8)) return false;
  mode->control = static_cast<ControlMode>(GetU32(frame, 0));
  mode->input = static_cast<InputMode>(GetU32(frame, 4));
  return true;
}

bool DecodeSetInputTorque(const CanFrame& frame, int node, float* torque_Nm) {
  if (!IsData(frame, node, Command::kSetInputTorque, 4)) return false;
  const float read = GetF32(frame, 0);
  if (!std::isfinite(read)) return false;
  *torque_Nm = read;
  return true;
}

}  // namespace armada::odrive
