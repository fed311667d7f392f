#include "host/sim/board_process.h"

#include <cmath>
#include <utility>

#include "hil/same_instant.h"

namespace armada {

BoardProcess::BoardProcess(const ScenarioConfig& scenario, int arm_id)
    : timing_(scenario.fleet.timing), faults_(scenario.faults, arm_id) {}

bool BoardProcess::IsOnTime(int64_t k) const {
  return !killed_ && !busy_ && k >= first_tick_ && !faults_.Kills(TimeOf(k)) && !faults_.Stops(TimeOf(k));
}

BoardProcess::Turn BoardProcess::Begin(int64_t k) {
  if (faults_.Kills(TimeOf(k))) {
    killed_ = true;
    busy_ = false;
    return Turn::kNone;
  }
  if (killed_) {
    killed_ = false;
    first_tick_ = k + std::llround(timing_.bring_up_s / timing_.period_s);
    missed_since_ = 0;
    ++starts_;
    return Turn::kStart;
  }
  if (busy_ || faults_.Stops(TimeOf(k))) {
    ++missed_since_;
    return Turn::kMissed;
  }
  if (k < first_tick_) return Turn::kStarts;
  tick_ = k;
  busy_ = true;
  done_s_.reset();
  missed_ = std::exchange(missed_since_, 0);
  return Turn::kTick;
}

bool BoardProcess::Answers(double t_s, bool samples_complete) {
  if (!busy_ || faults_.Kills(t_s) || faults_.Stops(t_s)) return false;
  const double samples_by_s = TimeOf(tick_) + timing_.feedback_timeout_s;
  if (!done_s_ && (samples_complete || !faults_.any() || t_s >= samples_by_s - kSameInstant_s)) {
    done_s_ = t_s + faults_.ComputeTime_s(t_s);
  }
  if (!done_s_ || t_s < *done_s_ - kSameInstant_s) return false;
  busy_ = false;
  return true;
}

}  // namespace armada
