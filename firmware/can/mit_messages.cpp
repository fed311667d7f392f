#include "firmware/can/mit_messages.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "firmware/can/damiao_messages.h"

namespace armada::mit {
namespace {

constexpr auto kUnsigned = CanSignal::Kind::kUnsigned;
constexpr auto kSigned = CanSignal::Kind::kSigned;
constexpr auto kBig = CanSignal::ByteOrder::kBig;

constexpr CanSignal kCommandPosition{"position", 7, 16, kUnsigned, kBig, "rad"};
constexpr CanSignal kCommandVelocity{"velocity", 23, 12, kUnsigned, kBig, "rad/s"};
constexpr CanSignal kCommandKp{"kp", 27, 12, kUnsigned, kBig, "N m/rad"};
constexpr CanSignal kCommandKd{"kd", 47, 12, kUnsigned, kBig, "N m s/rad"};
constexpr CanSignal kCommandTorque{"torque", 51, 12, kUnsigned, kBig, "N m"};
constexpr CanSignal kSpecialCode{"special", 39, 32, kUnsigned, kBig};
constexpr uint32_t kSpecialPrefix = 0xFFFF'FF00;

constexpr CanSignal kNode{"node", 7, 8, kUnsigned, kBig};
constexpr CanSignal kDamiaoNode{"node", 3, 4, kUnsigned, kBig};
constexpr CanSignal kDamiaoStatus{"status", 7, 4, kUnsigned, kBig};
constexpr CanSignal kReplyPosition{"position", 15, 16, kUnsigned, kBig, "rad"};
constexpr CanSignal kReplyVelocity{"velocity", 31, 12, kUnsigned, kBig, "rad/s"};
constexpr CanSignal kReplyTorque{"torque", 35, 12, kUnsigned, kBig, "N m"};
constexpr CanSignal kTemperature{"temperature", 55, 8, kSigned, kBig, "degC"};
constexpr CanSignal kRotorTemperature{"rotor_temperature", 63, 8, kSigned, kBig, "degC"};
constexpr CanSignal kError{"error", 63, 8, kUnsigned, kBig};

/// What an emulated drive's temperatures are.
constexpr double kRoom_degC = 25.0;

constexpr uint32_t LastCode(const CanSignal& signal) {
  return (1u << signal.bits) - 1;
}

/// The field with its joint's range, -max to max.
CanSignal Symmetric(CanSignal field, double max) {
  field.scale = 2.0 * max / LastCode(field);
  field.offset = -max;
  return field;
}

/// The field with its joint's range, 0 to max.
CanSignal FromZero(CanSignal field, double max) {
  field.scale = max / LastCode(field);
  return field;
}

uint32_t TruncatedAndWrapped(const CanSignal& field, double value, double max) {
  const double code = (value + max) * LastCode(field) / (2.0 * max);
  const double wrapped = std::fmod(std::trunc(code), LastCode(field) + 1.0);  // no integer holds every code
  return static_cast<uint32_t>(static_cast<int32_t>(wrapped)) & LastCode(field);
}

bool IsClassicData(const CanFrame& frame) {
  return !frame.extended && !frame.remote && !frame.error && !frame.fd;
}

CanFrame Frame(int id, uint8_t length) {
  CanFrame frame;
  frame.id = static_cast<uint32_t>(id);
  frame.length = length;
  return frame;
}

CanSignal NodeOf(const JointDriveConfig& joint) {
  return joint.profile == DriveProfile::kDamiao ? kDamiaoNode : kNode;
}

/// Bytes of a reply that it has at least.
uint8_t ReplyLength(const JointDriveConfig& joint) {
  return joint.profile == DriveProfile::kMiniCheetah ? 6 : 8;
}

}  // namespace

double TorqueStep_Nm(const MitConfig& config) {
  return Symmetric(kCommandTorque, config.torque_max_Nm).scale;
}

uint32_t TorqueCode(const MitConfig& config, double tau_Nm, double limit_Nm) {
  const auto code = [&](double torque_Nm) {
    const double max = config.torque_max_Nm;
    return (std::clamp(torque_Nm, -max, max) + max) / (2.0 * max) * LastCode(kCommandTorque);
  };
  const double low = std::ceil(code(-limit_Nm));
  const double high = std::floor(code(limit_Nm));
  if (low > high) return kZeroTorqueCode;
  return static_cast<uint32_t>(std::clamp(std::ceil(code(tau_Nm) - 0.5), low, high));
}

CanFrame EncodeTorque(const JointDriveConfig& joint, uint32_t torque_code) {
  CanFrame frame = Frame(joint.node_id, 8);
  PutRaw(kCommandPosition, LastCode(kCommandPosition) / 2, &frame);
  PutRaw(kCommandVelocity, LastCode(kCommandVelocity) / 2, &frame);
  PutRaw(kCommandTorque, torque_code, &frame);
  frame.latest_only = true;
  return frame;
}

CanFrame EncodeSpecial(const JointDriveConfig& joint, Special special) {
  CanFrame frame = Frame(joint.node_id, 8);
  std::fill_n(frame.data.begin(), 7, uint8_t{0xFF});
  frame.data[7] = static_cast<uint8_t>(special);
  return frame;
}

CanFrame EncodeReply(const JointDriveConfig& joint, const Reply& reply) {
  const MitConfig& mit = joint.mit;
  CanFrame frame = Frame(mit.master_id, ReplyLength(joint));
  const auto put = [&](const CanSignal& field, double value, double max) {
    PutRaw(field, TruncatedAndWrapped(field, value, max), &frame);
  };
  put(kReplyPosition, reply.position_rad, mit.position_max_rad);
  put(kReplyVelocity, reply.velocity_rad_s, mit.velocity_max_rad_s);
  put(kReplyTorque, reply.torque_Nm, mit.torque_max_Nm);
  PutRaw(NodeOf(joint), static_cast<uint32_t>(joint.node_id), &frame);
  if (joint.profile == DriveProfile::kDamiao) {
    PutRaw(kDamiaoStatus, reply.status, &frame);
    PutPhysical(kTemperature, kRoom_degC, &frame);
    PutPhysical(kRotorTemperature, kRoom_degC, &frame);
  } else if (joint.profile == DriveProfile::kCubeMars) {
    PutPhysical(kTemperature, kRoom_degC, &frame);
    PutRaw(kError, reply.status, &frame);
  }
  return frame;
}

bool IsForDrive(const CanFrame& frame, const JointDriveConfig& joint) {
  return IsClassicData(frame) && frame.id == static_cast<uint32_t>(joint.node_id) && frame.length == 8;
}

bool DecodeSpecial(const CanFrame& frame, Special* special) {
  const bool all_ones =
      std::all_of(frame.data.begin(), frame.data.begin() + 7, [](uint8_t byte) { return byte == 0xFF; });
  if (!all_ones || frame.data[7] < 0xFB || frame.data[7] > 0xFE) return false;
  *special = static_cast<Special>(frame.data[7]);
  return true;
}

Command DecodeCommand(const CanFrame& frame, const JointDriveConfig& joint) {
  const MitConfig& mit = joint.mit;
  return {GetPhysical(frame, Symmetric(kCommandPosition, mit.position_max_rad)),
          GetPhysical(frame, Symmetric(kCommandVelocity, mit.velocity_max_rad_s)),
          GetPhysical(frame, FromZero(kCommandKp, mit.kp_max_Nm_rad)),
          GetPhysical(frame, FromZero(kCommandKd, mit.kd_max_Nms_rad)),
          GetPhysical(frame, Symmetric(kCommandTorque, mit.torque_max_Nm))};
}

bool IsFromDrive(const CanFrame& frame, const JointDriveConfig& joint) {
  return IsClassicData(frame) && frame.id == static_cast<uint32_t>(joint.mit.master_id) && frame.length > 0 &&
         GetRaw(frame, NodeOf(joint)) == static_cast<uint32_t>(joint.node_id);
}

bool DecodeReply(const CanFrame& frame, const JointDriveConfig& joint, Reply* reply) {
  const uint8_t length = ReplyLength(joint);
  const bool more_allowed = joint.profile == DriveProfile::kMiniCheetah;  // forks append voltage, temperature
  if (frame.length < length || (frame.length > length && !more_allowed)) return false;
  const MitConfig& mit = joint.mit;
  reply->position_rad = GetPhysical(frame, Symmetric(kReplyPosition, mit.position_max_rad));
  reply->velocity_rad_s = GetPhysical(frame, Symmetric(kReplyVelocity, mit.velocity_max_rad_s));
  reply->torque_Nm = GetPhysical(frame, Symmetric(kReplyTorque, mit.torque_max_Nm));
  reply->status = 0;
  if (joint.profile == DriveProfile::kDamiao) {
    reply->status = static_cast<uint8_t>(GetRaw(frame, kDamiaoStatus));
  } else if (joint.profile == DriveProfile::kCubeMars) {
    reply->status = static_cast<uint8_t>(GetRaw(frame, kError));
  }
  return true;
}

uint32_t PositionCode(const CanFrame& frame) {
  return GetRaw(frame, kReplyPosition);
}

std::vector<CanMessage> Messages(const JointDriveConfig& joint) {
  const MitConfig& mit = joint.mit;
  const auto node = static_cast<uint32_t>(joint.node_id);
  const auto master = static_cast<uint32_t>(mit.master_id);
  std::vector<CanMessage> messages;
  const auto special = [&](const char* name, Special code, const char* meaning) {
    messages.push_back({.name = name,
                        .id = node,
                        .length = 8,
                        .signals = {kSpecialCode},
                        .multiplexor = 0,
                        .multiplexor_raw = kSpecialPrefix | static_cast<uint32_t>(code),
                        .meaning = meaning});
  };
  special("Enable", Special::kEnable, "power stage on");
  special("Disable", Special::kDisable, "power stage off");
  special("SetZero", Special::kSetZero, "the present position is zero; not sent by the master");
  const bool damiao = joint.profile == DriveProfile::kDamiao;
  if (damiao) special("ClearFault", Special::kClearFault, "disabled, without a fault");
  messages.push_back(
      {.name = "Command",
       .id = node,
       .length = 8,
       .signals = {Symmetric(kCommandPosition, mit.position_max_rad),
                   Symmetric(kCommandVelocity, mit.velocity_max_rad_s),
                   FromZero(kCommandKp, mit.kp_max_Nm_rad), FromZero(kCommandKd, mit.kd_max_Nms_rad),
                   Symmetric(kCommandTorque, mit.torque_max_Nm)},
       .meaning = "motor side; the master sends gains of 0"});
  if (damiao) {
    for (CanMessage& message : damiao::Messages(joint)) messages.push_back(std::move(message));
  }
  std::vector<CanSignal> state = {NodeOf(joint), Symmetric(kReplyPosition, mit.position_max_rad),
                                  Symmetric(kReplyVelocity, mit.velocity_max_rad_s),
                                  Symmetric(kReplyTorque, mit.torque_max_Nm)};
  if (damiao) {
    state.insert(state.end(), {kDamiaoStatus, kTemperature, kRotorTemperature});
  } else if (joint.profile == DriveProfile::kCubeMars) {
    state.insert(state.end(), {kTemperature, kError});
  }
  messages.push_back({.name = "State",
                      .id = master,
                      .from_drive = true,
                      .length = ReplyLength(joint),
                      .signals = std::move(state),
                      .multiplexor = 0,
                      .multiplexor_raw = node,
                      .meaning = "answer to every frame to the drive, motor side"});
  return messages;
}

}  // namespace armada::mit
