#pragma once

#include <vector>

#include "hil/leader_path.h"
#include "hil/scenario.h"

namespace armada {

/// Torque that one joint needs at most, against its limit.
struct TorqueNeed {
  double needed_Nm = 0.0;
  double limit_Nm = 0.0;

  double share() const { return needed_Nm / limit_Nm; }
};

/// What following the leader asks of one arm.
///
/// Reach: over the whole path, or the scenario's length of it. The rest is sampled on a motion without any
/// control error: the joints move exactly as the reference velocity (1.5) of the arm's own configuration
/// wants, subtask included, from an elbow bent to either side. Torque is that of the nominal parameters on
/// this motion, plus the disturbance's amplitude: an estimate of the need after settling, not a bound;
/// feedback and convergence come on top.
struct PathCheck {
  double reach_outer_m =
      0.0;  ///< smallest distance to the outer edge of the reachable ring; negative: out of reach
  double reach_inner_m = 0.0;  ///< and to its inner edge
  double sigma_min = 0.0;      ///< smallest singular value of J on the motion, m/rad
  double error_m = 0.0;  ///< largest distance from the leader: what limits and damping of the reference leave
  double error_allowed_m = 0.0;     ///< by the scenario's criterion
  double sampled_s = 0.0;           ///< length of the motion
  double clearance_m = 0.0;         ///< least distance of a link from an obstacle; infinite without obstacles
  double limit_margin_rad = 0.0;    ///< least distance of a joint from a limit; infinite without limits
  std::vector<TorqueNeed> torques;  ///< by joint

  /// Index of the joint that comes closest to its limit.
  size_t WorstJoint() const;
};

/// @pre the scenario has a leader.
PathCheck CheckPath(const ScenarioConfig& scenario, const ArmEntry& entry, const LeaderPath& leader);

}  // namespace armada
