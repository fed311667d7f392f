#pragma once

#include <vector>

#include "hil/emulated_arm.h"
#include "host/campaign/trial_facts.h"
#include "host/campaign/violation.h"

namespace armada {

/// Judges where arms go: those that no fault concerns track the leader; those to whom nobody brings its state
/// hold in time; none is driven about far from it.
class FollowingJudge {
 public:
  FollowingJudge(const ScenarioConfig& trial, Violations* violations);

  /// `state`: as the board tells it, the number on the wire.
  void OnState(size_t arm, double t_s, int state);
  void OnMoment(size_t arm, double t_s, const EmulatedArm& bench, double error_m);

 private:
  struct Arm {
    int id;
    double follow_max_s;  ///< it may take so long to come to follow
    bool must_track = false;
    bool off_track = false;
    bool knew = true;  ///< somebody told it of the leader when the fleet had settled
    bool late = false;
    double near_s = 0.0;  ///< for how long it has been near the leader
    double wild_s = 0.0;  ///< for how long it has been driven about
  };

  /// Of each arm, whether somebody told it of the leader in some of the time.
  std::vector<bool> ToldIn(double from_s, double to_s) const;
  void Complain(Invariant invariant, double t_s, const Arm& arm, const std::string& what);

  TrialFacts facts_;
  CriterionConfig criterion_;
  double far_m_;
  bool starts_running_;
  std::vector<Arm> arms_;
  std::vector<bool> told_;  ///< of each arm: somebody brings it the leader's state
  double told_at_s_ = -1.0;
  Violations* violations_;
};

}  // namespace armada
