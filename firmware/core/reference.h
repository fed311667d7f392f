#pragma once

#include "firmware/core/parameter.h"
#include "firmware/core/planar_arm.h"
#include "firmware/core/pseudoinverse.h"
#include "firmware/core/subtask.h"
#include "firmware/core/zeta.h"

namespace armada {

/// Robust form of (1.5): the convergence velocity alpha (x_hat - x) is bounded in speed and in braking.
struct ReferenceConfig {
  double alpha_per_tick = 4.0;
  bool implicit_pull = true;
  double approach_speed_m_s = 3.0;
  double braking_share = 0.9;
  double braking_min_m_s2 = 1.0;
  double joint_speed_rad_s = 8.0;
  double reach_inner_margin_m = 0.01;
  double reach_outer_margin_m = 0.005;
  int iterations = 3;

  void Visit(ParameterVisitor& parameter) {
    parameter(
        {"alpha_per_tick", "1/period", 1e-3, 1e3,
         "alpha of (1.5) times the period, near the target; 5.87 is the sampled-data LQR's, less forgives "
         "more error of theta_hat"},
        alpha_per_tick);
    parameter({"implicit_pull", "", 0, 1,
               "the pull alpha e is that of the error left at the period's end; false: of the error before, "
               "stable for alpha below 1/period only"},
              implicit_pull);
    parameter({"approach_speed_m_s", "m/s", 1e-3, 100, "largest speed of approach, beside the leader's own"},
              approach_speed_m_s);
    parameter({"braking_share", "", 0.01, 1,
               "share of the torque left by motion, gravity and disturbance that the approach brakes with"},
              braking_share);
    parameter({"braking_min_m_s2", "m/s^2", 1e-3, 1e3, "braking of the approach where no torque is left"},
              braking_min_m_s2);
    parameter({"joint_speed_rad_s", "rad/s", 1e-3, 1e3, "largest component of dq_r; larger ones are scaled"},
              joint_speed_rad_s);
    parameter({"reach_inner_margin_m", "m", 0, 10, "distance kept from the inner edge of the reachable ring"},
              reach_inner_margin_m);
    parameter({"reach_outer_margin_m", "m", 0, 10, "distance kept from the outer edge of the reachable ring"},
              reach_outer_margin_m);
    parameter({"iterations", "", 1, 20, "fixed-point iterations for dq_r at the end of the period"},
              iterations);
  }
};

/// Speed at which the end effector is to approach x_hat, as a function of its distance: alpha |e| near the
/// target, then the speed v = sqrt(2 a_b (|e| - a_b / (2 alpha^2))) from which braking with a_b ends there,
/// then constant.
struct Approach {
  double alpha_1_s = 0.0;
  double braking_m_s2 = 0.0;  ///< a_b
  double speed_m_s = 0.0;

  /// Speed w at `error_m`. Implicit in time where `step_s` > 0: that of the distance error_m - step_s w which
  /// is left when w has acted for `step_s`, so that the pull is stable for any alpha.
  double Speed(double error_m, double step_s = 0.0) const;
};

/// Nearest point to x that the arm can reach with the margins.
TaskVector ClampToReach(const ReferenceConfig& config, const PlanarArm& arm, const TaskVector& x_m);

/// dq_r(q, zeta), n components. `synced` false: zero, the law then only brakes.
JointVector ReferenceVelocity(const ReferenceConfig& config, const Approach& approach,
                              const PseudoinverseConfig& pseudoinverse, const SubtaskConfig& subtask,
                              const PlanarArm& arm, const JointVector& q, const Zeta& zeta, bool synced);

/// The same where `q` was reached by going with `dq` for the last `step_s`, and dq_r is to take dq's place
/// over that time: the pull is implicit.
JointVector ReferenceVelocity(const ReferenceConfig& config, const Approach& approach,
                              const PseudoinverseConfig& pseudoinverse, const SubtaskConfig& subtask,
                              const PlanarArm& arm, const JointVector& q, const JointVector& dq,
                              double step_s, const Zeta& zeta, bool synced);

}  // namespace armada
