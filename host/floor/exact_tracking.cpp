#include "host/floor/exact_tracking.h"

#include "firmware/core/pseudoinverse.h"

namespace armada {
namespace {

// Damped only where an arm is as good as stretched, so that a torque can be found there at all.
constexpr PseudoinverseConfig kPseudoinverse{.damping_max_m = 0.02, .sigma_threshold_m = 0.03};

JointVector ToVector(const PlanarPlant::Joints& joints, int dof) {
  return Eigen::Map<const JointVector>(joints.data(), dof);
}

}  // namespace

ExactTracking::ExactTracking(const PlanarArmConfig& arm, const SubtaskConfig& subtask,
                             const LeaderPath& leader, double period_s)
    : arm_(arm),
      subtask_(subtask),
      leader_(&leader),
      period_s_(period_s),
      theta_(arm_.Theta()),
      lqr_(SampledLqr::Compute()) {}

JointVector ExactTracking::JointVelocity(const JointVector& q_rad, const TaskVector& v_m_s) const {
  const PlanarArm::Posture at = arm_.At(q_rad);
  const JacobianMatrix J = arm_.Jacobian(at);
  const InverseMatrix J_sharp = DampedPseudoinverse(kPseudoinverse, J).J_sharp;
  const JointVector dq_main = J_sharp * v_m_s;
  if (!HasSubtask(subtask_, arm_)) return dq_main;
  const JointVector phi = SubtaskVelocity(subtask_, arm_, {q_rad, at, J, J_sharp, dq_main});
  return dq_main + phi - J_sharp * (J * phi);
}

PlanarPlant::Joints ExactTracking::Torque(const MovingArm& arm) {
  const int n = arm_.dof();
  const JointVector q = ToVector(arm.plant.q_rad, n);
  const PlanarArm::Posture at = arm_.At(q);
  const Zeta leader = leader_->At(arm.t_s);
  const TaskVector e = arm_.Position(at) - leader.x_m;
  const TaskVector de = arm_.Jacobian(at) * ToVector(arm.plant.dq_rad_s, n) - leader.v_m_s;
  // The leader's velocity at the end, and of the error's what the LQR leaves.
  const double end_s = arm.t_s + period_s_;
  const TaskVector v_end = leader_->At(end_s).v_m_s + (1.0 - lqr_.k2_h) * de - (lqr_.k1_h2 / period_s_) * e;

  const JointMatrix H = arm_.Inertia(at, theta_);
  constexpr int kIterations = 8;
  constexpr double kTolerance_rad_s = 1e-6;
  for (int i = 0; i < kIterations; ++i) {
    MovingArm end = arm;
    end.AdvanceTo(end_s, tau_Nm_, kSearchStep_s);
    const JointVector missing =
        JointVelocity(ToVector(end.plant.q_rad, n), v_end) - ToVector(end.plant.dq_rad_s, n);
    if (missing.cwiseAbs().maxCoeff() < kTolerance_rad_s) break;
    Eigen::Map<JointVector>(tau_Nm_.data(), n) += H * missing / period_s_;
  }
  return tau_Nm_;
}

}  // namespace armada
