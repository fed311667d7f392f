#include "hil/faulty_signal.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/random.h"

namespace armada {
namespace {

double PeriodOf(const FaultConfig& fault) {
  switch (fault.way) {
    case FaultWay::kGarbage:
    case FaultWay::kDelayed:
    case FaultWay::kIntermittent:
      return FaultySignal::kPeriod_s;
    case FaultWay::kSlow:
      return fault.value;
    case FaultWay::kNone:
    case FaultWay::kOff:
    case FaultWay::kStuck:
    case FaultWay::kWrong:
      break;
  }
  return 0.0;
}

}  // namespace

FaultySignal::FaultySignal(const FaultConfig& fault, uint64_t seed)
    : way_(fault.way),
      is_factor_(fault.signal == FaultSignal::kCurrent),
      value_(fault.value),
      seed_(seed),
      period_s_(PeriodOf(fault)) {}

double FaultySignal::due_s() const {
  if (period_s_ <= 0.0) return std::numeric_limits<double>::infinity();
  return start_s_ + static_cast<double>(count_) * period_s_;
}

void FaultySignal::Update(double t_s, double truth) {
  if (!begun_) Begin(t_s, truth);
  while (due_s() <= t_s) Take(truth);
}

void FaultySignal::Begin(double t_s, double truth) {
  begun_ = true;
  start_s_ = t_s;
  held_ = truth;
  past_.fill(truth);
}

void FaultySignal::Take(double truth) {
  const uint64_t bits = RandomBits(seed_, kFaultStream, count_);
  if (way_ == FaultWay::kSlow) held_ = truth;
  if (way_ == FaultWay::kGarbage) held_ = Uniform(bits, -value_, value_);
  if (way_ == FaultWay::kIntermittent) dropped_ = Uniform(bits, 0.0, 1.0) < value_;
  if (way_ == FaultWay::kDelayed) {
    const size_t size = past_.size();
    const auto lag = std::min(static_cast<size_t>(std::lround(value_ / kPeriod_s)), size - 1);
    past_[count_ % size] = truth;
    held_ = past_[(count_ + size - lag) % size];
  }
  ++count_;
}

double FaultySignal::Of(double truth) const {
  switch (way_) {
    case FaultWay::kNone:
      break;
    case FaultWay::kOff:
      return 0.0;
    case FaultWay::kWrong:
      return is_factor_ ? value_ * truth : truth + value_;
    case FaultWay::kIntermittent:
      return dropped_ ? 0.0 : truth;
    case FaultWay::kStuck:
    case FaultWay::kGarbage:
    case FaultWay::kSlow:
    case FaultWay::kDelayed:
      return held_;
  }
  return truth;
}

}  // namespace armada
