#include "hil/cia402_node.h"

#include <algorithm>
#include <limits>

namespace armada {
namespace {

using canopen::NmtCommand;
using canopen::NmtState;
using canopen::Sdo;
using canopen::SdoAbort;
using canopen::SdoKind;
using cia402::Entry;

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr uint16_t kLastCommunicationObject = 0x1FFF;
constexpr std::array<uint16_t, 2> kTpdos = {cia402::kTpdo1, cia402::kTpdo2};

/// What 1600h:01 and its kin say.
struct Mapping {
  Entry entry;
  uint8_t bits;
};
Mapping MappingAt(const Cia402Dictionary& objects, uint16_t pdo, uint8_t sub) {
  const uint32_t raw = objects.Raw({cia402::MappingOf(pdo), sub});
  return {{static_cast<uint16_t>(raw >> 16), static_cast<uint8_t>(raw >> 8)}, static_cast<uint8_t>(raw)};
}
uint8_t CountOf(const Cia402Dictionary& objects, uint16_t pdo) {
  return static_cast<uint8_t>(objects.Raw({cia402::MappingOf(pdo), 0}));
}
CanSignal Place(uint32_t bit, const Mapping& mapping) {
  return {"", static_cast<uint16_t>(bit), mapping.bits};
}

}  // namespace

Cia402Node::Cia402Node(const JointDriveConfig& joint)
    : node_(joint.node_id),
      objects_(joint),
      heartbeat_s_(kNever),
      rpdo_deadline_s_(kNever),
      heartbeat_deadline_s_(kNever) {}

bool Cia402Node::Reads(const CanFrame& frame) const {
  return canopen::IsSync(frame) || frame.id == canopen::NodeId(canopen::kSdoRequestId, node_) ||
         frame.id == canopen::kNmtId;
}

double Cia402Node::Deadline() const {
  return std::min(rpdo_deadline_s_, heartbeat_deadline_s_);
}

double Cia402Node::NextEvent() const {
  return booting_ ? boot_s_ : std::min(heartbeat_s_, Deadline());
}

void Cia402Node::OnFrame(double t_s, const CanFrame& frame, FrameList* out) {
  if (booting_ || !canopen::IsPlain(frame)) return;
  NmtCommand command{};
  int node = 0;
  if (canopen::DecodeNmt(frame, &command, &node)) {
    if (node == 0 || node == node_) OnCommand(t_s, command, out);
    return;
  }
  const uint32_t consumer = objects_.Raw(cia402::kConsumerHeartbeat);
  NmtState heard{};
  if (canopen::DecodeHeartbeat(frame, static_cast<int>(consumer >> 16), &heard)) {
    const uint32_t timeout_ms = consumer & 0xFFFF;
    heartbeat_deadline_s_ = timeout_ms > 0 ? t_s + timeout_ms / 1000.0 : kNever;
    return;
  }
  if (Sdo request; state_ != NmtState::kStopped && canopen::DecodeSdoRequest(frame, node_, &request)) {
    return OnRequest(t_s, request, out);
  }
  if (state_ != NmtState::kOperational) return;
  if (canopen::IsSync(frame)) return OnSync(out);
  const bool rpdo = objects_.Exists(cia402::kRpdo1) &&
                    frame.id == (objects_.Raw(cia402::kRpdo1CobId) & canopen::kCanIdMask);
  if (rpdo) OnRpdo(t_s, frame, out);
}

void Cia402Node::OnTime(double t_s, FrameList* out) {
  if (booting_) {
    if (t_s < boot_s_) return;
    booting_ = false;
    out->Push(canopen::EncodeHeartbeat(node_, NmtState::kBootUp));
    return;
  }
  if (t_s >= heartbeat_s_) {
    out->Push(canopen::EncodeHeartbeat(node_, state_));
    const double period_s = objects_.Raw(cia402::kProducerHeartbeat) / 1000.0;
    while (heartbeat_s_ <= t_s) heartbeat_s_ += period_s;
  }
  if (t_s >= rpdo_deadline_s_) {
    rpdo_deadline_s_ = kNever;
    Lose(canopen::kRpdoTimeout);
  }
  if (t_s >= heartbeat_deadline_s_) {
    heartbeat_deadline_s_ = kNever;
    Lose(canopen::kHeartbeatError);
    constexpr uint32_t kToPreOperational = 0;
    constexpr uint32_t kToStopped = 2;
    const uint32_t behaviour = objects_.Raw(cia402::kErrorBehaviour);
    if (behaviour == kToPreOperational && state_ == NmtState::kOperational) {
      Enter(NmtState::kPreOperational, out);
    } else if (behaviour == kToStopped) {
      Enter(NmtState::kStopped, out);
    }
  }
}

void Cia402Node::OnCommand(double t_s, NmtCommand command, FrameList* out) {
  switch (command) {
    case NmtCommand::kStart:
      return Enter(NmtState::kOperational, out);
    case NmtCommand::kStop:
      return Enter(NmtState::kStopped, out);
    case NmtCommand::kPreOperational:
      return Enter(NmtState::kPreOperational, out);
    case NmtCommand::kResetNode:
      reset_ = true;
      return Reset(t_s, UINT16_MAX);
    case NmtCommand::kResetCommunication:
      if (state_ == NmtState::kOperational) Lose(0);
      return Reset(t_s, kLastCommunicationObject);
  }
}

void Cia402Node::Enter(NmtState state, FrameList* out) {
  if (state == state_) return;
  if (state_ == NmtState::kOperational) Lose(0);
  state_ = state;
  rpdo_deadline_s_ = kNever;
  to_receive_.reset();
  syncs_ = {};
  if (state != NmtState::kOperational) return;
  for (const uint16_t pdo : kTpdos) {
    const bool on_event = objects_.Raw({pdo, 2}) > canopen::kMaxSyncs;
    if (on_event && objects_.Exists(pdo)) Transmit(pdo, out);
  }
}

void Cia402Node::Reset(double t_s, uint16_t last_object) {
  objects_.Reset(0, last_object);
  booting_ = true;
  state_ = NmtState::kPreOperational;
  boot_s_ = t_s + kBoot_s;
  heartbeat_s_ = rpdo_deadline_s_ = heartbeat_deadline_s_ = kNever;
  to_receive_.reset();
}

void Cia402Node::Lose(uint16_t error_code) {
  if (!loss_ || *loss_ == 0) loss_ = error_code;
}

void Cia402Node::OnSync(FrameList* out) {
  if (to_receive_) Receive(*to_receive_);
  to_receive_.reset();
  for (size_t i = 0; i < kTpdos.size(); ++i) {
    const uint32_t type = objects_.Raw({kTpdos[i], 2});
    if (!objects_.Exists(kTpdos[i]) || type > canopen::kMaxSyncs || ++syncs_[i] < type) continue;
    syncs_[i] = 0;
    Transmit(kTpdos[i], out);
  }
}

void Cia402Node::OnRequest(double t_s, const Sdo& request, FrameList* out) {
  SdoAbort abort = SdoAbort::kUnknownCommand;
  switch (request.kind) {
    case SdoKind::kAbort:
      return;
    case SdoKind::kOther:
      break;
    case SdoKind::kUpload: {
      uint8_t bytes = 0;
      uint32_t raw = 0;
      abort = objects_.Read(request.entry, &bytes, &raw);
      if (abort != SdoAbort::kNone) break;
      out->Push(canopen::EncodeSdoUploadReply(node_, request.entry, bytes, raw));
      return;
    }
    case SdoKind::kDownload:
      abort = objects_.Write(request.entry, request.bytes, request.value);
      if (abort != SdoAbort::kNone) break;
      if (request.entry == cia402::kProducerHeartbeat) {
        heartbeat_s_ = request.value > 0 ? t_s + request.value / 1000.0 : kNever;
      }
      out->Push(canopen::EncodeSdoDownloadReply(node_, request.entry));
      return;
  }
  out->Push(canopen::EncodeSdoAbortReply(node_, request.entry, abort));
}

void Cia402Node::OnRpdo(double t_s, const CanFrame& frame, FrameList* out) {
  if (frame.length < LengthOf(cia402::kRpdo1)) {
    const auto reg = static_cast<uint8_t>(canopen::kGenericError | canopen::kCommunicationError);
    return SendEmergency({canopen::kPdoLengthError, reg}, out);
  }
  const uint32_t timeout_ms = objects_.Raw(cia402::kRpdo1Timeout);
  rpdo_deadline_s_ = timeout_ms > 0 ? t_s + timeout_ms / 1000.0 : kNever;
  if (objects_.Raw(cia402::kRpdo1Type) > canopen::kMaxSyncs) {
    Receive(frame);
  } else {
    to_receive_ = frame;
  }
}

void Cia402Node::Receive(const CanFrame& frame) {
  uint32_t bit = 0;
  for (uint8_t sub = 1; sub <= CountOf(objects_, cia402::kRpdo1); ++sub) {
    const Mapping mapping = MappingAt(objects_, cia402::kRpdo1, sub);
    objects_.WriteMapped(mapping.entry, GetRaw(frame, Place(bit, mapping)));
    bit += mapping.bits;
  }
}

void Cia402Node::Transmit(uint16_t pdo, FrameList* out) const {
  CanFrame frame =
      canopen::PlainFrame(objects_.Raw({pdo, 1}) & canopen::kCanIdMask, static_cast<uint8_t>(LengthOf(pdo)));
  uint32_t bit = 0;
  for (uint8_t sub = 1; sub <= CountOf(objects_, pdo); ++sub) {
    const Mapping mapping = MappingAt(objects_, pdo, sub);
    PutRaw(Place(bit, mapping), objects_.Raw(mapping.entry), &frame);
    bit += mapping.bits;
  }
  out->Push(frame);
}

uint32_t Cia402Node::LengthOf(uint16_t pdo) const {
  uint32_t bits = 0;
  for (uint8_t sub = 1; sub <= CountOf(objects_, pdo); ++sub) bits += MappingAt(objects_, pdo, sub).bits;
  return bits / 8;
}

void Cia402Node::SendEmergency(const canopen::Emergency& emergency, FrameList* out) {
  objects_.Set(cia402::kErrorRegister, emergency.error_register);
  objects_.Set(cia402::kErrorCode, emergency.error_code);
  if (booting_ || state_ == NmtState::kStopped) return;
  out->Push(canopen::EncodeEmergency(node_, emergency));
}

}  // namespace armada
