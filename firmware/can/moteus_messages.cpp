#include "firmware/can/moteus_messages.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

namespace armada::moteus {
namespace {

constexpr auto kUnsigned = CanSignal::Kind::kUnsigned;
constexpr auto kSigned = CanSignal::Kind::kSigned;
constexpr auto kFloat32 = CanSignal::Kind::kFloat32;
constexpr auto kLittle = CanSignal::ByteOrder::kLittle;

constexpr uint16_t Byte(unsigned n) {
  return static_cast<uint16_t>(8 * n);
}

/// A byte of a layout that is the same in every frame: subframe types, counts and register numbers.
struct Constant {
  uint8_t at;
  uint8_t value;
};

// Subframes: 0x0_ write, 0x1_ read, 0x2_ answer; + 0x0 int8, 0x4 int16, 0x8 int32, 0xC float; the low two
// bits are the number of registers, 0: a byte with it follows. Then the first register.
constexpr Constant kStop[] = {{0, 0x01}, {1, 0x00}, {2, 0x00}};
constexpr uint8_t kStopLength = 3;
constexpr Constant kTorque[] = {{0, 0x01},  {1, 0x00}, {2, 0x0A},  // int8 0x000: mode 10
                                {3, 0x0C},  {4, 0x05}, {5, 0x20},  // floats 0x020 to 0x024
                                {26, 0x0D}, {27, 0x27}};           // float 0x027
constexpr uint8_t kTorqueLength = 32;
constexpr Constant kStateQuery[] = {{0, 0x11}, {1, 0x00},                         // int8 0x000
                                    {2, 0x1F}, {3, 0x01}, {4, 0x11}, {5, 0x0F}};  // 3 floats, int8 0x00F
constexpr uint8_t kStateQueryLength = 6;
constexpr Constant kSetupQuery[] = {{6, 0x1D},
                                    {7, 0x27},  // the same, and float 0x027,
                                    {8, 0x19},
                                    {9, 0x82},
                                    {10, 0x02}};  // int32 0x102
constexpr uint8_t kSetupQueryLength = 11;
constexpr Constant kState[] = {{0, 0x21}, {1, 0x00}, {3, 0x2F}, {4, 0x01}, {17, 0x21}, {18, 0x0F}};
constexpr uint8_t kStateLength = 20;
constexpr Constant kSetup[] = {{20, 0x2D}, {21, 0x27}, {26, 0x29}, {27, 0x82}, {28, 0x02}};
constexpr uint8_t kSetupLength = 48;  // 33 and padding

constexpr CanSignal kModeCommand{"mode", Byte(2), 8, kSigned};
constexpr CanSignal kPositionCommand{"position", Byte(6), 32, kFloat32, kLittle, "turns"};
constexpr CanSignal kVelocityCommand{"velocity", Byte(10), 32, kFloat32, kLittle, "turns/s"};
constexpr CanSignal kTorqueCommand{"torque", Byte(14), 32, kFloat32, kLittle, "N m"};
constexpr CanSignal kKpScale{"kp_scale", Byte(18), 32, kFloat32};
constexpr CanSignal kKdScale{"kd_scale", Byte(22), 32, kFloat32};
constexpr CanSignal kWatchdogCommand{"watchdog", Byte(28), 32, kFloat32, kLittle, "s"};

constexpr CanSignal kMode{"mode", Byte(2), 8, kSigned};
constexpr CanSignal kPosition{"position", Byte(5), 32, kFloat32, kLittle, "turns"};
constexpr CanSignal kVelocity{"velocity", Byte(9), 32, kFloat32, kLittle, "turns/s"};
constexpr CanSignal kTorqueNow{"torque", Byte(13), 32, kFloat32, kLittle, "N m"};
constexpr CanSignal kFault{"fault", Byte(19), 8, kUnsigned};
constexpr CanSignal kWatchdog{"watchdog", Byte(22), 32, kFloat32, kLittle, "s"};
constexpr CanSignal kMapVersion{"register_map", Byte(29), 32, kSigned};

// What tells layouts of one identifier apart.
constexpr CanSignal kFirstRead{"setup", Byte(6), 8};
constexpr CanSignal kFourthAnswer{"setup", Byte(20), 8};

CanFrame Frame(uint32_t id, uint8_t length, std::span<const Constant> constants) {
  CanFrame frame = EmptyFrame(id);
  frame.length = length;
  for (const Constant& constant : constants) frame.data[constant.at] = constant.value;
  return frame;
}

bool Has(const CanFrame& frame, std::span<const Constant> constants) {
  return std::all_of(constants.begin(), constants.end(),
                     [&](const Constant& constant) { return frame.data[constant.at] == constant.value; });
}

float GetFloat(const CanFrame& frame, const CanSignal& signal) {
  return static_cast<float>(GetPhysical(frame, signal));
}

/// The part that the answers to both queries begin with.
bool DecodeStatePart(const CanFrame& frame, State* state) {
  if (!Has(frame, kState)) return false;
  const State read{static_cast<Mode>(static_cast<int8_t>(GetRaw(frame, kMode))), GetFloat(frame, kPosition),
                   GetFloat(frame, kVelocity), GetFloat(frame, kTorqueNow),
                   static_cast<uint8_t>(GetRaw(frame, kFault))};
  if (!std::isfinite(read.position_turns) || !std::isfinite(read.velocity_turns_s) ||
      !std::isfinite(read.torque_Nm)) {
    return false;
  }
  *state = read;
  return true;
}

}  // namespace

const char* FaultName(uint32_t fault) {
  constexpr uint32_t kFirst = 32;
  constexpr const char* kNames[] = {
      "calibration fault",    "motor driver fault",
      "over voltage",         "encoder fault",
      "motor not configured", "PWM cycle overrun",
      "over temperature",     "outside position limit",
      "under voltage",        "configuration changed",
      "theta invalid",        "position invalid",
      "driver enable fault",  "stop position deprecated",
      "timing violation",     "back-EMF feed-forward without acceleration limit",
      "invalid limits"};
  return fault >= kFirst && fault - kFirst < std::size(kNames) ? kNames[fault - kFirst] : "unknown";
}

CanFrame EmptyFrame(uint32_t id) {
  CanFrame frame;
  frame.id = id;
  frame.extended = id > 0x7FF;
  frame.fd = true;
  frame.bitrate_switch = true;
  return frame;
}

void Pad(CanFrame* frame) {
  while (!IsValid(*frame)) frame->data[frame->length++] = kNop;
}

CanFrame EncodeStop(const JointDriveConfig& joint) {
  return Frame(RequestId(joint.moteus.source_id, joint.node_id, false), kStopLength, kStop);
}

CanFrame EncodeTorque(const JointDriveConfig& joint, float torque_Nm) {
  CanFrame frame = Frame(RequestId(joint.moteus.source_id, joint.node_id, false), kTorqueLength, kTorque);
  PutPhysical(kPositionCommand, std::numeric_limits<double>::quiet_NaN(), &frame);  // from where it is
  PutPhysical(kTorqueCommand, torque_Nm, &frame);
  PutPhysical(kWatchdogCommand, joint.watchdog_s, &frame);
  frame.latest_only = true;
  return frame;
}

CanFrame EncodeStateQuery(const JointDriveConfig& joint) {
  return Frame(RequestId(joint.moteus.source_id, joint.node_id, true), kStateQueryLength, kStateQuery);
}

CanFrame EncodeSetupQuery(const JointDriveConfig& joint) {
  CanFrame frame = EncodeStateQuery(joint);
  for (const Constant& constant : kSetupQuery) frame.data[constant.at] = constant.value;
  frame.length = kSetupQueryLength;
  Pad(&frame);
  return frame;
}

bool IsFromDrive(const CanFrame& frame, const JointDriveConfig& joint) {
  const uint32_t id = AnswerId(joint.moteus.source_id, joint.node_id);
  return !frame.remote && !frame.error && frame.id == id && (frame.extended || id <= 0x7FF);
}

bool DecodeState(const CanFrame& frame, State* state) {
  return frame.fd && frame.length == kStateLength && DecodeStatePart(frame, state);
}

bool DecodeSetup(const CanFrame& frame, Setup* setup) {
  if (!frame.fd || frame.length != kSetupLength || !Has(frame, kSetup)) return false;
  const float watchdog_s = GetFloat(frame, kWatchdog);
  if (!DecodeStatePart(frame, &setup->state)) return false;
  setup->watchdog_s = watchdog_s;
  setup->register_map = static_cast<int32_t>(GetRaw(frame, kMapVersion));
  return true;
}

std::vector<CanMessage> Messages(const JointDriveConfig& joint) {
  const int source = joint.moteus.source_id;
  const auto message = [](const char* name, uint32_t id, bool from_drive, uint8_t length,
                          std::vector<CanSignal> signals, const char* meaning) {
    return CanMessage{.name = name,
                      .id = id,
                      .extended = id > 0x7FF,
                      .fd = true,
                      .from_drive = from_drive,
                      .length = length,
                      .signals = std::move(signals),
                      .meaning = meaning};
  };
  const uint32_t command_id = RequestId(source, joint.node_id, false);
  const uint32_t query_id = RequestId(source, joint.node_id, true);
  const uint32_t answer_id = AnswerId(source, joint.node_id);
  std::vector<CanMessage> messages = {
      message("Stop", command_id, false, kStopLength, {kModeCommand}, "clears faults and the time-out"),
      message("Torque", command_id, false, kTorqueLength,
              {kModeCommand, kPositionCommand, kVelocityCommand, kTorqueCommand, kKpScale, kKdScale,
               kWatchdogCommand},
              "torque only: position NaN, no gains; feeds the watchdog"),
      message("SetupQuery", query_id, false, 12, {kFirstRead}, "bring-up"),
      message("StateQuery", query_id, false, kStateQueryLength, {}, "does not feed the watchdog"),
      message("Setup", answer_id, true, kSetupLength,
              {kFourthAnswer, kMode, kPosition, kVelocity, kTorqueNow, kFault, kWatchdog, kMapVersion},
              "answer to SetupQuery"),
      message("State", answer_id, true, kStateLength, {kMode, kPosition, kVelocity, kTorqueNow, kFault},
              "answer to StateQuery"),
  };
  const auto told_by_first = [&](size_t i, uint32_t raw) {
    messages[i].multiplexor = 0;
    messages[i].multiplexor_raw = raw;
  };
  told_by_first(0, static_cast<uint32_t>(Mode::kStopped));
  told_by_first(1, static_cast<uint32_t>(Mode::kPosition));
  told_by_first(2, 0x1D);
  told_by_first(4, 0x2D);
  return messages;
}

}  // namespace armada::moteus
