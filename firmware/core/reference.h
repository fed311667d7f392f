#pragma once

#include "firmware/core/planar_arm.h"
#include "firmware/core/pseudoinverse.h"
#include "firmware/core/subtask.h"
#include "firmware/core/zeta.h"

namespace armada {

/// Robust form of (1.5): the convergence velocity alpha (x_hat - x) is bounded in speed and in braking.
struct ReferenceConfig {
  double alpha_1_s = 50.0;
  double approach_speed_m_s = 2.0;
  double approach_braking_m_s2 = 6.0;
  double joint_speed_rad_s = 8.0;
  double reach_inner_margin_m = 0.01;
  double reach_outer_margin_m = 0.005;

  template <class Visitor>
  void Visit(Visitor& parameter) {
    parameter({"alpha_1_s", "1/s", 1e-3, 1e3, "alpha of (1.5) near the target; at most 1/period"}, alpha_1_s);
    parameter({"approach_speed_m_s", "m/s", 1e-3, 100, "largest speed of approach, beside the leader's own"},
              approach_speed_m_s);
    parameter(
        {"approach_braking_m_s2", "m/s^2", 1e-3, 1e3, "braking of the approach: v = sqrt(2 a_b (|e| - ..))"},
        approach_braking_m_s2);
    parameter({"joint_speed_rad_s", "rad/s", 1e-3, 1e3, "largest component of dq_r; larger ones are scaled"},
              joint_speed_rad_s);
    parameter({"reach_inner_margin_m", "m", 0, 10, "distance kept from the inner edge of the reachable ring"},
              reach_inner_margin_m);
    parameter({"reach_outer_margin_m", "m", 0, 10, "distance kept from the outer edge of the reachable ring"},
              reach_outer_margin_m);
  }
};

/// Speed of approach at distance `error_m`: alpha |e| near the target, then constant braking, then constant
/// speed.
double ApproachSpeed(const ReferenceConfig& config, double error_m);

/// Nearest point to x that the arm can reach with the margins.
TaskVector ClampToReach(const ReferenceConfig& config, const PlanarArm& arm, const TaskVector& x_m);

/// dq_r(q, zeta), n components. `synced` false: zero, the law then only brakes.
JointVector ReferenceVelocity(const ReferenceConfig& config, const PseudoinverseConfig& pseudoinverse,
                              const SubtaskConfig& subtask, const PlanarArm& arm, const JointVector& q,
                              const Zeta& zeta, bool synced);

}  // namespace armada
