#include "host/campaign/following_judge.h"

#include <algorithm>
#include <cmath>

#include "host/campaign/told_state.h"
#include "host/campaign/trial.h"

namespace armada {
namespace {

constexpr double kHoldWithin_s = 0.110;
constexpr double kTick_s = 0.010;  // a state is told with the next tick
// Stops take up to 1.5 s, and the drives' own ramp another half.
constexpr double kWildMax_s = 2.5;
constexpr double kMoment_s = 0.001;
// An arm that has been near the leader for so long follows it.
constexpr double kNear_s = 0.5;

double FastestJoint_rad_s(const PlanarPlant& plant) {
  double fastest_rad_s = 0.0;
  for (int i = 0; i < plant.dof(); ++i) {
    fastest_rad_s = std::max(fastest_rad_s, std::abs(plant.dq_rad_s[static_cast<size_t>(i)]));
  }
  return fastest_rad_s;
}

bool IsDriven(const EmulatedArm& bench) {
  const PlanarPlant::Joints torque_Nm = bench.Torque();
  return std::any_of(torque_Nm.begin(), torque_Nm.end(), [](double tau_Nm) { return tau_Nm != 0.0; });
}

/// Arms may follow a leader to where it says it is, on both axes.
double LargestLie_m(const ScenarioConfig& trial) {
  double lie_m = 0.0;
  for (const FaultConfig& fault : trial.faults) {
    if (fault.kind == FaultKind::kLeaderJumps) lie_m += std::sqrt(2.0) * std::abs(fault.value);
  }
  return lie_m;
}

}  // namespace

FollowingJudge::FollowingJudge(const ScenarioConfig& trial, Violations* violations)
    : facts_(trial),
      criterion_(trial.criterion),
      far_m_(trial.criterion.diverged_error_m + LargestLie_m(trial)),
      starts_running_(trial.start.mode == StartMode::kRunning),
      violations_(violations) {
  const std::vector<bool> reached = facts_.Reached([&](size_t arm) { return !facts_.IsTouched(arm); });
  for (size_t i = 0; i < trial.fleet.arms.size(); ++i) {
    const ArmEntry& entry = trial.fleet.arms[i];
    const bool may_stop = entry.control.supervisor.fleet_stop == FleetStop::kHold && facts_.anyone_touched();
    arms_.push_back({.id = entry.id,
                     .follow_max_s = entry.control.supervisor.follow_max_s,
                     .must_track = starts_running_ && !facts_.leader_touched() && !facts_.IsTouched(i) &&
                                   reached[i] && !may_stop});
  }
}

void FollowingJudge::Complain(Invariant invariant, double t_s, const Arm& arm, const std::string& what) {
  violations_->push_back({invariant, t_s, arm.id, what});
}

std::vector<bool> FollowingJudge::ToldIn(double from_s, double to_s) const {
  if (facts_.IsSilent(-1, from_s, to_s)) return std::vector<bool>(arms_.size(), false);
  return facts_.Reached([&](size_t arm) { return !facts_.IsSilent(static_cast<int>(arm), from_s, to_s); });
}

void FollowingJudge::OnState(size_t index, double t_s, int state) {
  Arm& arm = arms_[index];
  const bool follows = Follows(state);
  if (!follows) arm.near_s = 0.0;
  // Where messages are lost at random, more of them must be missing before a silence is one.
  if (facts_.loses_messages() || facts_.IsTouched(index)) return;
  if (t_s != told_at_s_) {
    told_at_s_ = t_s;
    told_ = ToldIn(t_s - kHoldWithin_s - kTick_s, t_s);
  }
  // One that started running and has never known where the leader is stands, and may go on to wait.
  if (starts_running_ && t_s < kSettled_s) {
    arm.knew = told_[index];
    return;
  }
  const bool late = arm.knew && !told_[index] && follows;
  if (late && !arm.late) {
    Complain(
        Invariant::kHoldsInTime, t_s, arm,
        "it follows on, and nobody has told it of the leader for " + std::to_string(kHoldWithin_s) + " s");
  }
  arm.late = late;
}

void FollowingJudge::OnMoment(size_t index, double t_s, const EmulatedArm& bench, double error_m) {
  Arm& arm = arms_[index];
  const bool off_track = arm.must_track && t_s > kSettled_s && error_m > criterion_.error_max_m;
  if (off_track && !arm.off_track) {
    Complain(Invariant::kOthersTrack, t_s, arm, std::to_string(error_m) + " m from the leader");
  }
  arm.off_track = off_track;

  const double speed_rad_s = FastestJoint_rad_s(bench.plant());
  const bool wild = t_s > kSettled_s && error_m > far_m_ &&
                    speed_rad_s > criterion_.standing_speed_max_rad_s && IsDriven(bench);
  const bool near = error_m <= criterion_.error_max_m || arm.near_s > kNear_s;
  arm.near_s = near ? arm.near_s + kMoment_s : 0.0;
  const double allowed_s = arm.near_s > kNear_s ? kWildMax_s : kWildMax_s + arm.follow_max_s;
  const bool was_wild = arm.wild_s > allowed_s;
  // Whoever is driven to and fro stands for a moment now and then.
  arm.wild_s = std::max(0.0, arm.wild_s + (wild ? kMoment_s : -kMoment_s));
  if (arm.wild_s > allowed_s && !was_wild) {
    Complain(Invariant::kNoWildMotion, t_s, arm,
             "driven for " + std::to_string(allowed_s) + " s, " + std::to_string(error_m) +
                 " m from the leader, at " + std::to_string(speed_rad_s) + " rad/s");
  }
}

}  // namespace armada
