#include "firmware/core/reference.h"

#include <algorithm>
#include <cmath>

namespace armada {

double Approach::Speed(double error_m, double step_s) const {
  const double linear_until_m = braking_m_s2 / (alpha_1_s * alpha_1_s);
  double speed = alpha_1_s * error_m / (1.0 + alpha_1_s * step_s);
  if (error_m - step_s * speed > linear_until_m) {
    const double lost_m_s = braking_m_s2 * step_s;
    speed = std::sqrt(lost_m_s * lost_m_s + 2.0 * braking_m_s2 * (error_m - 0.5 * linear_until_m)) - lost_m_s;
  }
  return std::min(speed, speed_m_s);
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

JointVector ReferenceVelocity(const ReferenceConfig& config, const Approach& approach,
                              const PseudoinverseConfig& pseudoinverse, const SubtaskConfig& subtask,
                              const PlanarArm& arm, const JointVector& q, const Zeta& zeta, bool synced) {
  return ReferenceVelocity(config, approach, pseudoinverse, subtask, arm, q, q, 0.0, zeta, synced);
}

JointVector ReferenceVelocity(const ReferenceConfig& config, const Approach& approach,
                              const PseudoinverseConfig& pseudoinverse, const SubtaskConfig& subtask,
                              const PlanarArm& arm, const JointVector& q, const JointVector& dq,
                              double step_s, const Zeta& zeta, bool synced) {
  if (!synced) return JointVector::Zero(arm.dof());
  const PlanarArm::Posture at = arm.At(q);
  const JacobianMatrix J = arm.Jacobian(at);
  const InverseMatrix J_sharp = DampedPseudoinverse(pseudoinverse, J).J_sharp;

  // The error there would be if dq had been v_hat's.
  TaskVector e = ClampToReach(config, arm, zeta.x_m) - arm.Position(at);
  if (step_s > 0.0) e += step_s * (J * dq - zeta.v_m_s);
  const double error_m = e.norm();
  TaskVector r = zeta.v_m_s;
  // Not `> 0`: an estimate that is not a number must show in the torque, where the gate stops it.
  if (error_m != 0.0) r += (approach.Speed(error_m, step_s) / error_m) * e;

  JointVector dq_r = J_sharp * r;  // (1.5)
  if (HasSubtask(subtask, arm)) {
    const JointVector phi = SubtaskVelocity(subtask, arm, {q, at, J, J_sharp, dq_r});
    dq_r += phi - J_sharp * (J * phi);
  }
  const double largest = dq_r.cwiseAbs().maxCoeff();
  if (largest > config.joint_speed_rad_s) dq_r *= config.joint_speed_rad_s / largest;
  return dq_r;
}

}  // namespace armada
