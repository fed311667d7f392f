#pragma once

#include <array>

#include "hil/leader_path.h"
#include "hil/scenario.h"

namespace armada {

/// One row of Assumption (A2): beta_k above the leader's derivative.
struct BetaMargin {
  double beta = 0.0;
  double leader = 0.0;  ///< supremum of the leader's speed, acceleration or jerk, infinity norm

  double ratio() const { return beta / leader; }  ///< infinite for a leader at rest
  bool holds() const { return beta > leader; }
};

/// Assumption (A2), and the bound t_f_max that the paper's finite-time theorem draws from it.
struct EstimatorCheck {
  std::array<BetaMargin, 3> margins;  ///< v (m/s), a (m/s^2), jerk (m/s^3)
  /// Time after which every estimate is exact in continuous time, over all start states of the scenario;
  /// infinite where (A2) fails.
  double settled_max_s = 0.0;

  bool holds() const;
};

/// @pre the scenario has a leader.
EstimatorCheck CheckEstimator(const ScenarioConfig& scenario, const LeaderPath& leader);

/// The theorem's condition on K_r of one arm: lambda_min(K_r) >= sup |d|, a 2-norm. A disturbance bounded by
/// the amplitude in each of n joints is only bounded by amplitude sqrt(n) in it.
struct DisturbanceCheck {
  double K_r_min_Nm = 0.0;
  double d_2norm_Nm = 0.0;

  bool holds() const { return K_r_min_Nm >= d_2norm_Nm; }
};
DisturbanceCheck CheckDisturbance(const ArmEntry& entry, const DisturbanceConfig& disturbance);

}  // namespace armada
