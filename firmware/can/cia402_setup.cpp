#include "firmware/can/cia402_setup.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "firmware/can/canopen_messages.h"
#include "firmware/can/cia402_messages.h"
#include "firmware/can/cia402_objects.h"
#include "firmware/can/value_format.h"

namespace armada {
namespace {

using canopen::Entry;
using canopen::Sdo;
using canopen::SdoAbort;
using canopen::SdoKind;

constexpr uint32_t kWhole = 0xFFFF'FFFF;
/// Of a PDO's COB-ID: whether it exists, and its identifier. Drives set the other bits as they like.
constexpr uint32_t kCobIdMask = canopen::kPdoInvalid | canopen::kCanIdMask;

/// As the 16 bits of a timer hold it; never 0, which would turn the timer off.
uint32_t Milliseconds(double time_s) {
  return static_cast<uint32_t>(std::clamp(std::round(1000.0 * time_s), 1.0, double{UINT16_MAX}));
}

std::string NameOf(Entry entry) {
  char text[16];
  std::snprintf(text, sizeof text, "%04X:%02X", static_cast<unsigned>(entry.index),
                static_cast<unsigned>(entry.sub));
  return text;
}

}  // namespace

Cia402Setup::Cia402Setup(const JointDriveConfig& joint)
    : node_(joint.node_id),
      max_attempts_(joint.bring_up_attempts),
      timeout_ns_(std::llround(1e9 * joint.cia402.sdo_timeout_s)) {
  const Cia402Config& config = joint.cia402;
  Require(cia402::kDeviceType, 402, 0xFFFF, "the profile in the low 16 bits");
  Require(cia402::kSupportedModes, 1u << 9, 1u << 9, "bit 9, cyclic synchronous torque");
  Require(cia402::kRatedTorque, static_cast<uint32_t>(std::llround(1000.0 * config.rated_torque_Nm)), kWhole,
          "cia402.rated_torque_Nm in mN m");

  MapPdo(cia402::kRpdo1, canopen::NodeId(canopen::kRpdo1Id, node_), canopen::kOnEvent, cia402::kRpdo1Fields);
  Write(cia402::kRpdo1Timeout, Milliseconds(joint.watchdog_s));
  MapPdo(cia402::kTpdo1, canopen::NodeId(canopen::kTpdo1Id, node_) | canopen::kNoRemoteFrame,
         canopen::kOnEverySync, cia402::kTpdo1Fields);
  MapPdo(cia402::kTpdo2, canopen::NodeId(canopen::kTpdo2Id, node_) | canopen::kNoRemoteFrame,
         canopen::kOnEverySync, cia402::kTpdo2Fields);
  DisablePdo(cia402::kTpdo2 + 1, canopen::NodeId(0x380, node_));
  DisablePdo(cia402::kTpdo2 + 2, canopen::NodeId(0x480, node_));

  Write(cia402::kConsumerHeartbeat,
        static_cast<uint32_t>(config.master_node_id) << 16 | Milliseconds(config.heartbeat_timeout_s));
  Write(cia402::kProducerHeartbeat, Milliseconds(config.heartbeat_s));
  constexpr uint32_t kFault = 1;
  Write(cia402::kAbortConnection, kFault);
  Write(cia402::kQuickStopOption, static_cast<uint32_t>(config.quick_stop));
  Write(cia402::kFaultReactionOption, static_cast<uint32_t>(config.fault_reaction));
  Write(cia402::kMaxTorque, cia402::MaxTorqueOf(joint));
  Write(cia402::kTargetTorque, 0);
  Write(cia402::kMode, cia402::kCyclicSynchronousTorque);

  steps_.insert(steps_.end(), checks_.begin(), checks_.end());
}

void Cia402Setup::Write(Entry entry, uint32_t value, bool read_back) {
  const uint8_t bytes = cia402::BytesOf(cia402::Find(entry)->type);
  steps_.push_back({.entry = entry, .write = true, .bytes = bytes, .value = value});
  const uint32_t mask = bytes == 4 ? kWhole : (1u << 8 * bytes) - 1;
  if (read_back) checks_.push_back({.entry = entry, .value = value, .mask = mask});
}

void Cia402Setup::Require(Entry entry, uint32_t value, uint32_t mask, const char* source) {
  steps_.push_back({.entry = entry, .value = value, .mask = mask, .source = source});
}

/// In the order of CiA 301, 7.5.2.36: the PDO ends to exist, its mapping is emptied, filled and counted, then
/// it exists again.
template <class Fields>
void Cia402Setup::MapPdo(uint16_t pdo, uint32_t cob_id, uint32_t type, const Fields& fields) {
  const uint16_t mapping = cia402::MappingOf(pdo);
  Write({pdo, 1}, canopen::kPdoInvalid | cob_id, false);
  Write({pdo, 2}, type);
  Write({mapping, 0}, 0, false);
  uint8_t sub = 0;
  for (const cia402::PdoField& field : fields) Write({mapping, ++sub}, cia402::MappingOf(field));
  Write({mapping, 0}, sub);
  Write({pdo, 1}, cob_id, false);
  checks_.push_back({.entry = {pdo, 1}, .value = cob_id & kCobIdMask, .mask = kCobIdMask});
}

void Cia402Setup::DisablePdo(uint16_t pdo, uint32_t cob_id) {
  steps_.push_back({.entry = {pdo, 1},
                    .write = true,
                    .optional = true,
                    .value = canopen::kPdoInvalid | canopen::kNoRemoteFrame | cob_id});
  checks_.push_back(
      {.entry = {pdo, 1}, .optional = true, .value = canopen::kPdoInvalid, .mask = canopen::kPdoInvalid});
}

void Cia402Setup::Restart() {
  result_ = Result::kRunning;
  at_ = 0;
  attempts_ = 0;
}

void Cia402Setup::Tick(int64_t now_ns, FrameList* out) {
  if (result_ != Result::kRunning) return;
  if (attempts_ > 0 && now_ns - asked_ns_ < timeout_ns_) return;
  if (attempts_ == max_attempts_) {
    result_ = Result::kSilent;
    return;
  }
  const Step& step = steps_[at_];
  out->Push(step.write ? canopen::EncodeSdoDownload(node_, step.entry, step.bytes, step.value)
                       : canopen::EncodeSdoUpload(node_, step.entry));
  ++attempts_;
  asked_ns_ = now_ns;
}

void Cia402Setup::OnReply(const Sdo& reply) {
  if (result_ != Result::kRunning || attempts_ == 0) return;
  const Step& step = steps_[at_];
  if (reply.entry != step.entry) return;  // late: of a request that was repeated
  const auto abort = static_cast<SdoAbort>(reply.value);
  if (reply.kind == SdoKind::kAbort) {
    if (!step.optional || (abort != SdoAbort::kNoObject && abort != SdoAbort::kNoSubIndex)) {
      return Refuse(reply);
    }
  } else if (reply.kind != (step.write ? SdoKind::kDownload : SdoKind::kUpload)) {
    return;
  } else if (!step.write && ((reply.value ^ step.value) & step.mask) != 0) {
    return Refuse(reply);
  }
  attempts_ = 0;
  if (++at_ == steps_.size()) result_ = Result::kDone;
}

void Cia402Setup::Refuse(const Sdo& reply) {
  result_ = Result::kRefused;
  answer_ = reply;
}

bool Cia402Setup::NoWatchdog() const {
  return result_ == Result::kRefused && steps_[at_].entry == cia402::kRpdo1Timeout;
}

std::string Cia402Setup::Explain() const {
  if (result_ == Result::kDone) return "";
  const Step& step = steps_[at_];
  const std::string what = (step.write ? "writing " : "reading ") + NameOf(step.entry);
  if (result_ == Result::kRefused && answer_.kind == SdoKind::kAbort) {
    return "SDO abort " + Hexadecimal(answer_.value, 8) + " (" +
           canopen::TextOf(static_cast<SdoAbort>(answer_.value)) + ") " + what;
  }
  if (result_ == Result::kRefused) {
    const uint32_t read = answer_.value & step.mask;
    return NameOf(step.entry) + " reads " +
           (step.source == nullptr ? Hexadecimal(read) + ", written was " + Hexadecimal(step.value)
                                   : std::to_string(read) + ", expected is " + std::to_string(step.value) +
                                         " (" + step.source + ")");
  }
  if (result_ == Result::kSilent || attempts_ > 1) return "no answer to SDO " + what;
  return "being configured, " + std::to_string(at_) + " of " + std::to_string(steps_.size()) + " SDOs";
}

}  // namespace armada
