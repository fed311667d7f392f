#pragma once

#include <vector>

#include "host/floor/moving_arm.h"

namespace armada {

/// Joints as an arm's sensors tell them, joint side.
struct JointReadings {
  PlanarPlant::Joints q_rad{};
  PlanarPlant::Joints dq_rad_s{};
};

struct ExactFilterConfig {
  std::vector<double> q_deviation_rad;  ///< standard deviation of each joint's measured position
  std::vector<double> dq_deviation_rad_s;
  double disturbance_Nm = 0.0;  ///< standard deviation of what is not known of the disturbance, by joint
  double missed_share = 0.003;  ///< of the disturbance's effect, what the linearised motion misses
};

/// Extended Kalman filter on (q, dq, d) of one arm with the plant itself as model: the mean moves as the true
/// arm does, the covariance by the sensitivities of that motion. d is the deviation of the disturbance from
/// what was to be expected: unknown anew at each change, constant in between.
class ExactFilter {
 public:
  ExactFilter(const ExactFilterConfig& config, const MovingArm& start);

  /// Corrects by the readings of this instant.
  void Correct(const JointReadings& readings);
  /// Moves on under the drives' torques, in steps of at most `step_s`.
  void AdvanceTo(double end_s, const DelayedTorques& torques, double step_s);

  const MovingArm& belief() const { return belief_; }

 private:
  using Matrix = BoundedMatrix<3 * kMaxDof, 3 * kMaxDof>;
  using Vector = BoundedVector<3 * kMaxDof>;

  void RenewDeviation();
  Matrix Sensitivity(double end_s, const DelayedTorques& torques) const;

  ExactFilterConfig config_;
  Eigen::Index dof_;
  MovingArm belief_;
  Vector measurement_variance_;  ///< 2 n
  Matrix P_;                     ///< covariance of (q, dq, d), 3 n
};

}  // namespace armada
