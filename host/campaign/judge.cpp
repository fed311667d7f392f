#include "host/campaign/judge.h"

#include <algorithm>

#include "armada/estimate_t.hpp"
#include "firmware/app/heap_counter.h"

namespace armada {

Judge::Judge(const ScenarioConfig& trial)
    : torques_(trial, &violations_),
      consent_(trial, &violations_),
      following_(trial, &violations_),
      faults_(trial.faults),
      told_(trial.fleet.arms.size(), 0),
      met_(trial.faults.size()) {
  for (const ArmEntry& arm : trial.fleet.arms) ids_.push_back(arm.id);
}

void Judge::Enter(size_t) {
  allocations_ = HeapCounter::Allocations();
}

void Judge::Leave(size_t arm) {
  const uint64_t allocations = HeapCounter::Allocations() - allocations_;
  if (allocations == 0 || allocated_) return;
  allocated_ = true;
  violations_.push_back(
      {Invariant::kNoHeap, now_s_, ids_[arm], std::to_string(allocations) + " allocations"});
}

void Judge::OnFrame(size_t arm, double t_s, const CanFrame& frame) {
  torques_.OnFrame(arm, t_s, frame);
}

void Judge::OnEstimate(size_t arm, double t_s, std::span<const uint8_t> payload) {
  now_s_ = t_s;
  NoteMeetings(t_s);
  estimate_t message;
  if (message.decode(payload.data(), 0, static_cast<int>(payload.size())) < 0) return;
  const int state = static_cast<uint8_t>(message.state);
  told_[arm] = state;
  consent_.OnState(arm, t_s, state);
  following_.OnState(arm, t_s, state);
}

void Judge::OnMoment(size_t arm, double t_s, const EmulatedArm& bench, double error_m) {
  now_s_ = t_s;
  torques_.OnMoment(arm, t_s, bench);
  consent_.OnMoment(arm, t_s, bench);
  following_.OnMoment(arm, t_s, bench, error_m);
}

void Judge::NoteMeetings(double t_s) {
  for (size_t i = 0; i < faults_.size(); ++i) {
    if (met_[i] || faults_[i].at_s > t_s) continue;
    const auto arm = std::find(ids_.begin(), ids_.end(), faults_[i].arm);
    if (arm != ids_.end()) met_[i] = told_[static_cast<size_t>(arm - ids_.begin())];
  }
}

}  // namespace armada
