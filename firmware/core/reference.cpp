#include "firmware/core/reference.h"

#include <algorithm>
#include <cmath>

namespace armada {

double ApproachSpeed(const ReferenceConfig& config, double error_m) {
  const double linear_until_m = config.approach_braking_m_s2 / (config.alpha_1_s * config.alpha_1_s);
  const double speed = error_m <= linear_until_m
                           ? config.alpha_1_s * error_m
                           : std::sqrt(2.0 * config.approach_braking_m_s2 * (error_m - 0.5 * linear_until_m));
  return std::min(speed, config.approach_speed_m_s);
}

TaskVector ClampToReach(const ReferenceConfig& config, const PlanarArm& arm, const TaskVector& x_m) {
  const TaskVector base = arm.Base();
  const double radius = (x_m - base).norm();
  const double inner = arm.reach_min_m() + config.reach_inner_margin_m;
  const double outer = arm.reach_max_m() - config.reach_outer_margin_m;
  if (radius > outer) return base + (outer / radius) * (x_m - base);
  // At the very centre there is no direction to push along, and none is needed: J# is damped there.
  if (radius < inner && radius > 1e-9) return base + (inner / radius) * (x_m - base);
  return x_m;
}

JointVector ReferenceVelocity(const ReferenceConfig& config, const PseudoinverseConfig& pseudoinverse,
                              const SubtaskConfig& subtask, const PlanarArm& arm, const JointVector& q,
                              const Zeta& zeta, bool synced) {
  if (!synced) return JointVector::Zero(arm.dof());
  const PlanarArm::Posture at = arm.At(q);
  const JacobianMatrix J = arm.Jacobian(at);
  const InverseMatrix J_sharp = DampedPseudoinverse(pseudoinverse, J).J_sharp;

  const TaskVector e = ClampToReach(config, arm, zeta.x_m) - arm.Position(at);
  const double error_m = e.norm();
  TaskVector r = zeta.v_m_s;
  // Not `> 0`: an estimate that is not a number must show in the torque, where the gate stops it.
  if (error_m != 0.0) r += (ApproachSpeed(config, error_m) / error_m) * e;

  JointVector dq_r = J_sharp * r;  // (1.5)
  if (arm.dof() > J.rows() && subtask.kind != SubtaskKind::kNone) {
    const JointVector phi = SubtaskVelocity(subtask, arm, q, at, J);
    dq_r += phi - J_sharp * (J * phi);
  }
  const double largest = dq_r.cwiseAbs().maxCoeff();
  if (largest > config.joint_speed_rad_s) dq_r *= config.joint_speed_rad_s / largest;
  return dq_r;
}

}  // namespace armada
