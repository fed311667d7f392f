#include "firmware/can/damiao_messages.h"

#include "firmware/can/mit_messages.h"

namespace armada::damiao {
namespace {

constexpr uint32_t kRequestId = 0x7FF;

constexpr CanSignal kNode{"node", 0, 16};
constexpr CanSignal kAccess{"access", 16, 8};
constexpr CanSignal kRegister{"register", 24, 8};
constexpr CanSignal kValue{"value", 32, 32};
/// Node and access as one number, for tables: what tells an answer from a state.
constexpr CanSignal kNodeAndAccess{"node_and_access", 0, 24};

CanFrame Encode(uint32_t id, const JointDriveConfig& joint, const RegisterAccess& content) {
  CanFrame frame;
  frame.id = id;
  frame.length = 8;
  PutRaw(kNode, static_cast<uint32_t>(joint.node_id), &frame);
  PutRaw(kAccess, static_cast<uint32_t>(content.access), &frame);
  PutRaw(kRegister, static_cast<uint32_t>(content.reg), &frame);
  PutRaw(kValue, content.raw, &frame);
  return frame;
}

bool Decode(uint32_t id, const CanFrame& frame, const JointDriveConfig& joint, RegisterAccess* content) {
  if (frame.extended || frame.remote || frame.error || frame.fd || frame.id != id || frame.length != 8) {
    return false;
  }
  const auto access = static_cast<Access>(GetRaw(frame, kAccess));
  if (GetRaw(frame, kNode) != static_cast<uint32_t>(joint.node_id)) return false;
  if (access != Access::kRead && access != Access::kWrite) return false;
  *content = {access, static_cast<Register>(GetRaw(frame, kRegister)), GetRaw(frame, kValue)};
  return true;
}

}  // namespace

const char* StatusName(uint32_t status) {
  switch (status) {
    case kDisabled:
      return "disabled";
    case kEnabled:
      return "enabled";
    case 0x5:
      return "sensor failure";
    case 0x6:
      return "parameter failure";
    case 0x8:
      return "over voltage";
    case 0x9:
      return "under voltage";
    case 0xA:
      return "over current";
    case 0xB:
      return "over temperature of the power stage";
    case 0xC:
      return "over temperature of the rotor";
    case kCommunicationLost:
      return "communication lost";
    case 0xE:
      return "overload";
    default:
      return "unknown";
  }
}

CanFrame EncodeRequest(const JointDriveConfig& joint, const RegisterAccess& request) {
  return Encode(kRequestId, joint, request);
}

CanFrame EncodeAnswer(const JointDriveConfig& joint, const RegisterAccess& answer) {
  return Encode(static_cast<uint32_t>(joint.mit.master_id), joint, answer);
}

bool DecodeRequest(const CanFrame& frame, const JointDriveConfig& joint, RegisterAccess* request) {
  return Decode(kRequestId, frame, joint, request);
}

bool DecodeAnswer(const CanFrame& frame, const JointDriveConfig& joint, RegisterAccess* answer) {
  // Byte 1 is the node's high byte, 0, where a state has the high byte of its position.
  static_assert(mit::kPositionMargin >= 0x100, "a state with that byte 0 must be of no use");
  return Decode(static_cast<uint32_t>(joint.mit.master_id), frame, joint, answer);
}

std::vector<CanMessage> Messages(const JointDriveConfig& joint) {
  const auto node = static_cast<uint32_t>(joint.node_id);
  std::vector<CanMessage> messages = {{.name = "RegisterRequest",
                                       .id = kRequestId,
                                       .length = 8,
                                       .signals = {kNode, kAccess, kRegister, kValue},
                                       .multiplexor = 0,
                                       .multiplexor_raw = node,
                                       .meaning = "access 0x33 read, 0x55 write; bits of a u32 or a float"}};
  for (const Access access : {Access::kRead, Access::kWrite}) {
    messages.push_back({.name = access == Access::kRead ? "RegisterRead" : "RegisterWritten",
                        .id = static_cast<uint32_t>(joint.mit.master_id),
                        .from_drive = true,
                        .length = 8,
                        .signals = {kNodeAndAccess, kRegister, kValue},
                        .multiplexor = 0,
                        .multiplexor_raw = node | static_cast<uint32_t>(access) << 16,
                        .meaning = "the register's value after the request"});
  }
  return messages;
}

}  // namespace armada::damiao
