#include "firmware/can/canopen_messages.h"

#include "firmware/can/canopen_sdo.h"

namespace armada::canopen {
namespace {

constexpr CanSignal kCommand{"nmt_command", 0, 8};
constexpr CanSignal kNode{"node", 8, 8};
constexpr CanSignal kState{"nmt_state", 0, 8};
constexpr CanSignal kErrorCode{"error_code", 0, 16};
constexpr CanSignal kErrorRegister{"error_register", 16, 8};
constexpr CanSignal kVendorLow{"vendor_error_low", 24, 32};
constexpr CanSignal kVendorHigh{"vendor_error_high", 56, 8};

bool Is(const CanFrame& frame, uint32_t id, uint8_t length) {
  return IsPlain(frame) && frame.id == id && frame.length == length;
}

}  // namespace

CanFrame PlainFrame(uint32_t id, uint8_t length) {
  CanFrame frame;
  frame.id = id;
  frame.length = length;
  return frame;
}

CanFrame EncodeNmt(NmtCommand command, int node) {
  CanFrame frame = PlainFrame(kNmtId, 2);
  PutRaw(kCommand, static_cast<uint32_t>(command), &frame);
  PutRaw(kNode, static_cast<uint32_t>(node), &frame);
  return frame;
}

CanFrame EncodeSync() {
  return PlainFrame(kSyncId, 0);
}

CanFrame EncodeHeartbeat(int node, NmtState state) {
  CanFrame frame = PlainFrame(NodeId(kHeartbeatId, node), 1);
  PutRaw(kState, static_cast<uint32_t>(state), &frame);
  return frame;
}

CanFrame EncodeEmergency(int node, const Emergency& emergency) {
  CanFrame frame = PlainFrame(NodeId(kEmergencyId, node), 8);
  PutRaw(kErrorCode, emergency.error_code, &frame);
  PutRaw(kErrorRegister, emergency.error_register, &frame);
  return frame;
}

bool DecodeNmt(const CanFrame& frame, NmtCommand* command, int* node) {
  if (!Is(frame, kNmtId, 2)) return false;
  const auto read = static_cast<NmtCommand>(GetRaw(frame, kCommand));
  switch (read) {
    case NmtCommand::kStart:
    case NmtCommand::kStop:
    case NmtCommand::kPreOperational:
    case NmtCommand::kResetNode:
    case NmtCommand::kResetCommunication:
      *command = read;
      *node = static_cast<int>(GetRaw(frame, kNode));
      return true;
  }
  return false;
}

bool IsSync(const CanFrame& frame) {
  return IsPlain(frame) && frame.id == kSyncId && frame.length <= 1;  // 1: with the counter of object 1019h
}

bool DecodeHeartbeat(const CanFrame& frame, int node, NmtState* state) {
  if (!Is(frame, NodeId(kHeartbeatId, node), 1)) return false;
  const auto read = static_cast<NmtState>(GetRaw(frame, kState));
  switch (read) {
    case NmtState::kBootUp:
    case NmtState::kStopped:
    case NmtState::kOperational:
    case NmtState::kPreOperational:
      *state = read;
      return true;
  }
  return false;
}

bool DecodeEmergency(const CanFrame& frame, int node, Emergency* emergency) {
  if (!Is(frame, NodeId(kEmergencyId, node), 8)) return false;
  emergency->error_code = static_cast<uint16_t>(GetRaw(frame, kErrorCode));
  emergency->error_register = static_cast<uint8_t>(GetRaw(frame, kErrorRegister));
  return true;
}

std::vector<CanMessage> Messages(int node, int master_node) {
  const std::vector<CanSignal> sdo(kSdoSignals.begin(), kSdoSignals.end());
  return {
      {.name = "Nmt",
       .id = kNmtId,
       .length = 2,
       .signals = {kCommand, kNode},
       .meaning = "1 start, 2 stop, 128 pre-operational, 129 reset node, 130 reset communication"},
      {.name = "Sync",
       .id = kSyncId,
       .signals = {},
       .meaning = "each drive samples its joint and sends TPDO 1 and 2"},
      {.name = "MasterHeartbeat",
       .id = NodeId(kHeartbeatId, master_node),
       .length = 1,
       .signals = {kState},
       .meaning = "of the master"},
      {.name = "Emergency",
       .id = NodeId(kEmergencyId, node),
       .from_drive = true,
       .length = 8,
       .signals = {kErrorCode, kErrorRegister, kVendorLow, kVendorHigh},
       .meaning = "an error came (code) or went (0)"},
      {.name = "SdoReply",
       .id = NodeId(kSdoReplyId, node),
       .from_drive = true,
       .length = 8,
       .signals = sdo,
       .meaning = "answer to a request; command 80h: abort, the value is its reason"},
      {.name = "SdoRequest",
       .id = NodeId(kSdoRequestId, node),
       .length = 8,
       .signals = sdo,
       .meaning = "command 40h reads an object, 23h, 2Bh, 2Fh write 4, 2, 1 bytes"},
      {.name = "Heartbeat",
       .id = NodeId(kHeartbeatId, node),
       .from_drive = true,
       .length = 1,
       .signals = {kState},
       .meaning = "0 boot-up, 4 stopped, 5 operational, 127 pre-operational"},
  };
}

}  // namespace armada::canopen
