#include "firmware/can/canopen_sdo.h"

#include "firmware/can/canopen_messages.h"

namespace armada::canopen {
namespace {

// The command byte: specifier in bits 7 to 5; of an expedited transfer with a value 4 - bytes in bits 3 and
// 2, bit 1 expedited, bit 0 "the number of bytes is told".
constexpr uint32_t kDownloadRequest = 1;
constexpr uint32_t kUploadRequest = 2;
constexpr uint32_t kUploadReply = 2;
constexpr uint32_t kDownloadReply = 3;
constexpr uint32_t kAbortTransfer = 4;
constexpr uint32_t kExpedited = 0x02;
constexpr uint32_t kSizeTold = 0x01;

constexpr uint32_t Specifier(uint32_t specifier) {
  return specifier << 5;
}
constexpr uint32_t WithValue(uint32_t specifier, uint8_t bytes) {
  return Specifier(specifier) | (4u - bytes) << 2 | kExpedited | kSizeTold;
}
constexpr uint32_t LowBytes(uint32_t value, uint8_t bytes) {
  return bytes >= 4 ? value : value & ((1u << 8 * bytes) - 1);
}

CanFrame Frame(uint32_t id, uint32_t command, Entry entry, uint32_t value) {
  CanFrame frame = PlainFrame(id, 8);
  PutRaw(kSdoSignals[0], command, &frame);
  PutRaw(kSdoSignals[1], entry.index, &frame);
  PutRaw(kSdoSignals[2], entry.sub, &frame);
  PutRaw(kSdoSignals[3], value, &frame);
  return frame;
}

/// `with_value` and `without`: specifiers of the two kinds of transfer in this direction.
Sdo Decode(const CanFrame& frame, uint32_t with_value, SdoKind its_kind, uint32_t without,
           SdoKind other_kind) {
  const uint32_t command = GetRaw(frame, kSdoSignals[0]);
  const uint32_t specifier = command >> 5;
  const uint32_t value = GetRaw(frame, kSdoSignals[3]);
  Sdo sdo;
  sdo.entry = {static_cast<uint16_t>(GetRaw(frame, kSdoSignals[1])),
               static_cast<uint8_t>(GetRaw(frame, kSdoSignals[2]))};
  if (specifier == kAbortTransfer) {
    sdo.kind = SdoKind::kAbort;
    sdo.bytes = 4;
    sdo.value = value;
  } else if (specifier == without) {
    sdo.kind = other_kind;
  } else if (specifier == with_value && (command & kExpedited) != 0) {
    sdo.kind = its_kind;
    sdo.bytes = static_cast<uint8_t>((command & kSizeTold) != 0 ? 4 - (command >> 2 & 3u) : 0);
    sdo.value = sdo.bytes == 0 ? value : LowBytes(value, sdo.bytes);
  }
  return sdo;
}

}  // namespace

CanFrame EncodeSdoDownload(int node, Entry entry, uint8_t bytes, uint32_t value) {
  return Frame(NodeId(kSdoRequestId, node), WithValue(kDownloadRequest, bytes), entry,
               LowBytes(value, bytes));
}

CanFrame EncodeSdoUpload(int node, Entry entry) {
  return Frame(NodeId(kSdoRequestId, node), Specifier(kUploadRequest), entry, 0);
}

CanFrame EncodeSdoDownloadReply(int node, Entry entry) {
  return Frame(NodeId(kSdoReplyId, node), Specifier(kDownloadReply), entry, 0);
}

CanFrame EncodeSdoUploadReply(int node, Entry entry, uint8_t bytes, uint32_t value) {
  return Frame(NodeId(kSdoReplyId, node), WithValue(kUploadReply, bytes), entry, LowBytes(value, bytes));
}

CanFrame EncodeSdoAbortReply(int node, Entry entry, SdoAbort abort) {
  return Frame(NodeId(kSdoReplyId, node), Specifier(kAbortTransfer), entry, static_cast<uint32_t>(abort));
}

bool DecodeSdoRequest(const CanFrame& frame, int node, Sdo* sdo) {
  if (!IsPlain(frame) || frame.id != NodeId(kSdoRequestId, node) || frame.length != 8) return false;
  *sdo = Decode(frame, kDownloadRequest, SdoKind::kDownload, kUploadRequest, SdoKind::kUpload);
  return true;
}

bool DecodeSdoReply(const CanFrame& frame, int node, Sdo* sdo) {
  if (!IsPlain(frame) || frame.id != NodeId(kSdoReplyId, node) || frame.length != 8) return false;
  *sdo = Decode(frame, kUploadReply, SdoKind::kUpload, kDownloadReply, SdoKind::kDownload);
  return true;
}

const char* TextOf(SdoAbort abort) {
  switch (abort) {
    case SdoAbort::kNone:
      return "no error";
    case SdoAbort::kTimeout:
      return "protocol timed out";
    case SdoAbort::kUnknownCommand:
      return "command not valid or unknown";
    case SdoAbort::kUnsupportedAccess:
      return "unsupported access to an object";
    case SdoAbort::kWriteOnly:
      return "object is write only";
    case SdoAbort::kReadOnly:
      return "object is read only";
    case SdoAbort::kNoObject:
      return "object does not exist";
    case SdoAbort::kNotMappable:
      return "object cannot be mapped to the PDO";
    case SdoAbort::kPdoTooLong:
      return "mapped objects exceed the length of the PDO";
    case SdoAbort::kIncompatibleParameter:
      return "parameter is incompatible";
    case SdoAbort::kIncompatibleDevice:
      return "incompatible within the device";
    case SdoAbort::kHardware:
      return "hardware error";
    case SdoAbort::kWrongLength:
      return "length does not match the type";
    case SdoAbort::kTooLong:
      return "too long for the type";
    case SdoAbort::kTooShort:
      return "too short for the type";
    case SdoAbort::kNoSubIndex:
      return "sub-index does not exist";
    case SdoAbort::kValueRange:
      return "value out of range";
    case SdoAbort::kValueTooHigh:
      return "value too high";
    case SdoAbort::kValueTooLow:
      return "value too low";
    case SdoAbort::kGeneral:
      return "general error";
    case SdoAbort::kCannotStore:
      return "cannot be stored";
    case SdoAbort::kLocalControl:
      return "cannot be stored because of local control";
    case SdoAbort::kDeviceState:
      return "not in the present state of the device";
  }
  return "reason unknown";
}

}  // namespace armada::canopen
