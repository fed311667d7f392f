#include "hil/faulty_status.h"

#include <algorithm>
#include <span>
#include <string_view>

#include "firmware/can/make_drive.h"
#include "hil/random.h"

namespace armada {
namespace {

/// A field that tells the state, and what it holds when the drive has failed.
struct StatusField {
  const char* message;
  const char* signal;
  uint32_t error;
  bool alone;
};

constexpr StatusField kODriveV06[] = {{"Heartbeat", "axis_error", 0x20, true},  // gate driver
                                      {"Heartbeat", "axis_state", 1, true}};
constexpr StatusField kODriveV05[] = {{"Heartbeat", "axis_error", 0x40, true},  // motor failed
                                      {"Heartbeat", "axis_state", 1, true}};
constexpr StatusField kDamiao[] = {{"State", "status", 0xA, false}};   // over-current
constexpr StatusField kCubeMars[] = {{"State", "error", 0x2, false}};  // over-current
constexpr StatusField kCia402[] = {{"Status", "statusword", 0x08, true},
                                   {"Heartbeat", "nmt_state", 0x04, true},
                                   {"Emergency", "error_code", 0x2310, true},
                                   {"Emergency", "error_register", 0x01, true}};
constexpr StatusField kMoteus[] = {{"State", "mode", 1, false},
                                   {"State", "fault", 33, false},  // motor driver fault
                                   {"Setup", "mode", 1, false},
                                   {"Setup", "fault", 33, false}};

std::span<const StatusField> FieldsOf(DriveProfile profile) {
  switch (profile) {
    case DriveProfile::kODriveCanSimple:
      return kODriveV06;
    case DriveProfile::kODriveCanSimpleV05:
      return kODriveV05;
    case DriveProfile::kDamiao:
      return kDamiao;
    case DriveProfile::kCubeMars:
      return kCubeMars;
    case DriveProfile::kCia402:
      return kCia402;
    case DriveProfile::kMoteus:
      return kMoteus;
    case DriveProfile::kMiniCheetah:
      break;
  }
  return {};
}

const CanSignal* Find(const CanMessage& message, std::string_view name) {
  const auto found = std::find_if(message.signals.begin(), message.signals.end(),
                                  [&](const CanSignal& signal) { return signal.name == name; });
  return found == message.signals.end() ? nullptr : &*found;
}

}  // namespace

bool TellsStatus(const JointDriveConfig& joint) {
  return !FieldsOf(joint.profile).empty();
}

std::vector<FaultyStatus::Teller> FaultyStatus::TellersOf(const JointDriveConfig& joint) {
  std::vector<Teller> tellers;
  for (const CanMessage& message : MessagesOf(joint)) {
    if (!message.from_drive) continue;
    Teller teller{.message = message, .multiplexor = std::nullopt, .alone = false, .error = {}};
    if (message.multiplexor >= 0)
      teller.multiplexor = message.signals[static_cast<size_t>(message.multiplexor)];
    teller.message.signals.clear();
    for (const StatusField& field : FieldsOf(joint.profile)) {
      const CanSignal* const signal = Find(message, field.signal);
      if (std::string_view(field.message) != message.name || signal == nullptr) continue;
      teller.error[teller.message.signals.size()] = field.error;
      teller.alone = field.alone;
      teller.message.signals.push_back(*signal);
    }
    if (!teller.message.signals.empty()) tellers.push_back(std::move(teller));
  }
  return tellers;
}

FaultyStatus::FaultyStatus(const JointDriveConfig& joint, const FaultConfig& fault, uint64_t seed)
    : way_(fault.way), value_(fault.value), seed_(seed), tellers_(TellersOf(joint)) {}

bool FaultyStatus::Is(const CanFrame& frame, const Teller& teller) {
  const CanMessage& message = teller.message;
  if (frame.remote || frame.error || frame.id != message.id || frame.extended != message.extended ||
      frame.length != message.length) {
    return false;
  }
  return !teller.multiplexor || GetRaw(frame, *teller.multiplexor) == message.multiplexor_raw;
}

bool FaultyStatus::Pass(double t_s, bool active, CanFrame* frame) {
  const auto teller = std::find_if(tellers_.begin(), tellers_.end(),
                                   [&](const Teller& candidate) { return Is(*frame, candidate); });
  if (teller == tellers_.end()) return true;
  const std::vector<CanSignal>& signals = teller->message.signals;
  Raw raw{};
  for (size_t i = 0; i < signals.size(); ++i) raw[i] = GetRaw(*frame, signals[i]);
  teller->past[teller->count++ % teller->past.size()] = {t_s, raw};
  if (!active) {
    teller->holds = false;
    return true;
  }
  const bool sent = Change(t_s, *teller, &raw);
  ++frames_;
  for (size_t i = 0; i < signals.size(); ++i) PutRaw(signals[i], raw[i], frame);
  return sent;
}

/// False: not sent.
bool FaultyStatus::Change(double t_s, Teller& teller, Raw* raw) {
  const uint64_t bits = RandomBits(seed_, kFaultStream, frames_);
  switch (way_) {
    case FaultWay::kNone:
      return true;
    case FaultWay::kOff:
      return Withhold(teller, raw);
    case FaultWay::kGarbage:
      for (size_t i = 0; i < raw->size(); ++i) (*raw)[i] = static_cast<uint32_t>(Mix(bits + i));
      return true;
    case FaultWay::kWrong:
      *raw = teller.error;
      return true;
    case FaultWay::kIntermittent:
      return Uniform(bits, 0.0, 1.0) >= value_ || Withhold(teller, raw);
    case FaultWay::kDelayed:
      *raw = RawAt(t_s - value_, teller);
      return true;
    case FaultWay::kStuck:
      // What it told last, before the fault.
      if (!teller.holds) teller.held.raw = RawAt(t_s - 1e-9, teller);
      break;
    case FaultWay::kSlow:
      if (teller.holds && t_s < teller.next_s && teller.alone) return false;
      if (!teller.holds || t_s >= teller.next_s) {
        teller.held.raw = *raw;
        teller.next_s = t_s + value_;
      }
      break;
  }
  teller.holds = true;
  *raw = teller.held.raw;
  return true;
}

bool FaultyStatus::Withhold(const Teller& teller, Raw* raw) const {
  if (teller.alone) return false;
  *raw = {};
  return true;
}

/// The newest told by that time, or else the oldest that is known.
FaultyStatus::Raw FaultyStatus::RawAt(double t_s, const Teller& teller) const {
  const size_t size = teller.past.size();
  const size_t known = std::min(teller.count, size);
  for (size_t back = 1; back <= known; ++back) {
    const Told& told = teller.past[(teller.count - back) % size];
    if (told.t_s <= t_s || back == known) return told.raw;
  }
  return {};
}

}  // namespace armada
