#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "firmware/can/frame.h"
#include "firmware/can/signal.h"

namespace armada::canopen {

/// Messages of CANopen (CiA 301 4.2) but SDOs and PDOs, for both sides of the bus: classic frames, 11-bit
/// identifier function code << 7 | node, little-endian. Encoders want node 1 to 127. Decoders return false,
/// and leave their results alone, unless the frame is the node's message of that name and well formed.

inline constexpr uint32_t kNmtId = 0x000;
inline constexpr uint32_t kSyncId = 0x080;
inline constexpr uint32_t kEmergencyId = 0x080;  // this and those below: + node
inline constexpr uint32_t kTpdo1Id = 0x180;
inline constexpr uint32_t kRpdo1Id = 0x200;
inline constexpr uint32_t kTpdo2Id = 0x280;
inline constexpr uint32_t kSdoReplyId = 0x580;
inline constexpr uint32_t kSdoRequestId = 0x600;
inline constexpr uint32_t kHeartbeatId = 0x700;
inline constexpr uint32_t kNodeMask = 0x07F;

/// Object 1400h:01 and its kin.
inline constexpr uint32_t kPdoInvalid = 0x8000'0000;     ///< the PDO does not exist
inline constexpr uint32_t kNoRemoteFrame = 0x4000'0000;  ///< it cannot be asked for
inline constexpr uint32_t kCanIdMask = 0x7FF;
/// Object 1400h:02 and its kin: 1 to 240 is every so many SYNCs.
inline constexpr uint32_t kOnEverySync = 1;
inline constexpr uint32_t kMaxSyncs = 240;
inline constexpr uint32_t kOnEvent = 255;  ///< of an RPDO: acts as soon as it comes

enum class NmtCommand : uint8_t {
  kStart = 1,
  kStop = 2,
  kPreOperational = 128,
  kResetNode = 129,
  kResetCommunication = 130,
};

enum class NmtState : uint8_t { kBootUp = 0, kStopped = 4, kOperational = 5, kPreOperational = 127 };

struct Emergency {
  uint16_t error_code = 0;     ///< 0: the error is gone
  uint8_t error_register = 0;  ///< object 1001h
};

/// Error codes of CiA 301 table 26 that are used here.
inline constexpr uint16_t kHeartbeatError = 0x8130;
inline constexpr uint16_t kPdoLengthError = 0x8210;
inline constexpr uint16_t kRpdoTimeout = 0x8250;
/// Bits of the error register, object 1001h.
inline constexpr uint8_t kGenericError = 0x01;
inline constexpr uint8_t kCommunicationError = 0x10;

/// True for a classic data frame with an 11-bit identifier.
constexpr bool IsPlain(const CanFrame& frame) {
  return !frame.extended && !frame.error && !frame.fd && !frame.remote;
}
constexpr uint32_t NodeId(uint32_t function, int node) {
  return function + static_cast<uint32_t>(node);
}
CanFrame PlainFrame(uint32_t id, uint8_t length);

CanFrame EncodeNmt(NmtCommand command, int node);
CanFrame EncodeSync();
CanFrame EncodeHeartbeat(int node, NmtState state);
CanFrame EncodeEmergency(int node, const Emergency& emergency);

/// `node` 0: all nodes.
bool DecodeNmt(const CanFrame& frame, NmtCommand* command, int* node);
bool IsSync(const CanFrame& frame);
bool DecodeHeartbeat(const CanFrame& frame, int node, NmtState* state);
bool DecodeEmergency(const CanFrame& frame, int node, Emergency* emergency);

/// All of the above and the SDOs, for one drive and its master.
std::vector<CanMessage> Messages(int node, int master_node);

}  // namespace armada::canopen
