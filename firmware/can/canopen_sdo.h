#pragma once

#include <array>
#include <cstdint>

#include "firmware/can/frame.h"
#include "firmware/can/signal.h"

namespace armada::canopen {

/// Service data objects (CiA 301 4.2, 7.2.4), expedited only: objects of up to four bytes, one request and
/// one reply each. For both sides of the bus.

/// Address in an object dictionary, written 6040:00 in messages to people.
struct Entry {
  uint16_t index = 0;
  uint8_t sub = 0;
  friend bool operator==(const Entry&, const Entry&) = default;
};

/// Reasons of an abort, CiA 301 table 22.
enum class SdoAbort : uint32_t {
  kNone = 0,
  kTimeout = 0x0504'0000,
  kUnknownCommand = 0x0504'0001,
  kUnsupportedAccess = 0x0601'0000,
  kWriteOnly = 0x0601'0001,
  kReadOnly = 0x0601'0002,
  kNoObject = 0x0602'0000,
  kNotMappable = 0x0604'0041,
  kPdoTooLong = 0x0604'0042,
  kIncompatibleParameter = 0x0604'0043,
  kIncompatibleDevice = 0x0604'0047,
  kHardware = 0x0606'0000,
  kWrongLength = 0x0607'0010,
  kTooLong = 0x0607'0012,
  kTooShort = 0x0607'0013,
  kNoSubIndex = 0x0609'0011,
  kValueRange = 0x0609'0030,
  kValueTooHigh = 0x0609'0031,
  kValueTooLow = 0x0609'0032,
  kGeneral = 0x0800'0000,
  kCannotStore = 0x0800'0020,
  kLocalControl = 0x0800'0021,
  kDeviceState = 0x0800'0022,
};

/// What the code says, "reason unknown" for one that is not listed above.
const char* TextOf(SdoAbort abort);

enum class SdoKind {
  kDownload,  ///< request: write; reply: written
  kUpload,    ///< request: read; reply: the value
  kAbort,     ///< value: an SdoAbort
  kOther,     ///< segmented and block transfers
};

struct Sdo {
  SdoKind kind = SdoKind::kOther;
  Entry entry;
  uint8_t bytes = 0;   ///< of the value; 0: the sender left it open, or there is none
  uint32_t value = 0;  ///< the low `bytes` bytes; the rest 0
};

CanFrame EncodeSdoDownload(int node, Entry entry, uint8_t bytes, uint32_t value);
CanFrame EncodeSdoUpload(int node, Entry entry);
CanFrame EncodeSdoDownloadReply(int node, Entry entry);
CanFrame EncodeSdoUploadReply(int node, Entry entry, uint8_t bytes, uint32_t value);
CanFrame EncodeSdoAbortReply(int node, Entry entry, SdoAbort abort);

/// False unless the frame is the node's SDO and eight bytes long.
bool DecodeSdoRequest(const CanFrame& frame, int node, Sdo* sdo);
bool DecodeSdoReply(const CanFrame& frame, int node, Sdo* sdo);

/// Fields of both.
inline constexpr std::array<CanSignal, 4> kSdoSignals = {
    {{"command", 0, 8}, {"index", 8, 16}, {"subindex", 24, 8}, {"value", 32, 32}}};

}  // namespace armada::canopen
