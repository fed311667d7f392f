#include "host/campaign/consent_judge.h"

#include <algorithm>

#include "hil/same_instant.h"
#include "host/campaign/told_state.h"

namespace armada {
namespace {

constexpr double kStartsBefore_s = 0.05;  // emulated fleets that start running do it at once
constexpr double kStartWithin_s = 1.2;    // a request is worth nothing after a second
constexpr double kArmWithin_s = 4.5;      // and arming takes up to three

bool IsPowered(int told) {
  return Follows(told) || told == kArming || told == kHold || told == kSafeStop;
}

}  // namespace

ConsentJudge::ConsentJudge(const ScenarioConfig& trial, Violations* violations)
    : operations_(trial.operations),
      starts_running_(trial.start.mode == StartMode::kRunning),
      violations_(violations) {
  for (const ArmEntry& entry : trial.fleet.arms) {
    arms_.push_back({entry.id, kInit, std::vector<bool>(entry.joints.size(), starts_running_)});
  }
}

bool ConsentJudge::Asked(const Arm& arm, Request request, double t_s, double within_s) const {
  return std::any_of(operations_.begin(), operations_.end(), [&](const OperatorConfig& operation) {
    return operation.request == request && (operation.arm == 0 || operation.arm == arm.id) &&
           operation.at_s <= t_s + kSameInstant_s && t_s <= operation.at_s + within_s;
  });
}

void ConsentJudge::OnState(size_t index, double t_s, int state) {
  Arm& arm = arms_[index];
  const int before = arm.told;
  arm.told = state;
  if (starts_running_ && t_s < kStartsBefore_s) return;
  const auto complain = [&](const char* what) {
    violations_->push_back({Invariant::kNothingRearms, t_s, arm.id,
                            what + std::to_string(before) + " to " + std::to_string(state)});
  };
  if (Follows(state) && !Follows(before) && !Asked(arm, Request::kStart, t_s, kStartWithin_s)) {
    complain("it follows without an operator's start: state ");
  }
  if (IsPowered(state) && !IsPowered(before) && !Asked(arm, Request::kArm, t_s, kArmWithin_s)) {
    complain("it gives torque without an operator's arm: state ");
  }
}

void ConsentJudge::OnMoment(size_t index, double t_s, const EmulatedArm& bench) {
  Arm& arm = arms_[index];
  for (size_t i = 0; i < arm.on.size(); ++i) {
    const bool on = bench.IsOn(i);
    const bool came_on = on && !arm.on[i];
    arm.on[i] = on;
    if (!came_on || Asked(arm, Request::kArm, t_s, kArmWithin_s)) continue;
    violations_->push_back(
        {Invariant::kNothingRearms, t_s, arm.id,
         "the drive of joint " + std::to_string(i + 1) + " comes on without an operator's arm"});
  }
}

}  // namespace armada
