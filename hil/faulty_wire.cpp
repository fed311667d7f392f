#include "hil/faulty_wire.h"

#include <algorithm>
#include <limits>

#include "hil/random.h"
#include "hil/same_instant.h"

namespace armada {
namespace {

bool IsOfWire(FaultKind kind) {
  return kind == FaultKind::kBusLoss || kind == FaultKind::kBusDelay || kind == FaultKind::kBusOff ||
         kind == FaultKind::kBusDown;
}

}  // namespace

FaultyWire::FaultyWire(std::vector<FaultConfig> faults, uint64_t seed)
    : faults_(std::move(faults)), seed_(seed), queue_(kCapacity) {}

bool FaultyWire::Passes(double t_s, const CanFrame& frame, Way way) {
  double delay_s = 0.0;
  for (size_t i = 0; i < faults_.size(); ++i) {
    const FaultConfig& fault = faults_[i];
    if (!fault.IsActive(t_s)) continue;
    if (fault.kind == FaultKind::kBusOff || fault.kind == FaultKind::kBusDown) return false;
    if (fault.kind == FaultKind::kBusDelay) delay_s += fault.value;
    if (fault.kind == FaultKind::kBusLoss &&
        Uniform(RandomBits(seed_, kFaultStream, frames_++, i), 0.0, 1.0) < fault.value) {
      return false;
    }
  }
  if (delay_s == 0.0 && count_ == 0) return true;
  if (count_ == kCapacity) return false;
  // A bus keeps the order: nothing overtakes what is still under way.
  const double last_s = count_ == 0 ? t_s : queue_[(first_ + count_ - 1) % kCapacity].due_s;
  queue_[(first_ + count_++) % kCapacity] = {std::max(t_s + delay_s, last_s), way, frame};
  return false;
}

double FaultyWire::NextArrival() const {
  return count_ == 0 ? std::numeric_limits<double>::infinity() : queue_[first_].due_s;
}

std::optional<FaultyWire::Late> FaultyWire::TakeArrived(double t_s) {
  if (NextArrival() > t_s + kSameInstant_s) return std::nullopt;
  const Late late = queue_[first_];
  first_ = (first_ + 1) % kCapacity;
  --count_;
  return late;
}

std::optional<FaultyWire> MakeFaultyWire(const std::vector<FaultConfig>& faults, int arm_id, uint64_t seed) {
  std::vector<FaultConfig> its;
  for (const FaultConfig& fault : faults) {
    if (fault.arm == arm_id && IsOfWire(fault.kind)) its.push_back(fault);
  }
  if (its.empty()) return std::nullopt;
  constexpr uint64_t kAfterTheJoints = kMaxDof;
  return FaultyWire(std::move(its),
                    RandomBits(seed, kFaultStream, static_cast<uint64_t>(arm_id), kAfterTheJoints));
}

}  // namespace armada
