#include "firmware/core/robust_law.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace armada {

RobustLaw::RobustLaw(const ControlConfig& config, const PlanarArm& arm, const ParameterVector& theta_hat,
                     double sample_to_torque_s)
    : config_(config),
      arm_(arm),
      latency_s_(sample_to_torque_s),
      theta_hat_(theta_hat),
      filter_(config.adaptation, arm),
      observer_(config.disturbance_observer, arm.dof()),
      governor_(config.governor, JointVector::Zero(arm.dof())),
      tau_committed_Nm_(JointVector::Zero(arm.dof())),
      tau_before_Nm_(JointVector::Zero(arm.dof())) {
  Project(config_.projection, arm_, theta_hat_);
}

JointVector RobustLaw::Torque(const LawInput& in) {
  period_s_ = in.period_s;
  if (started_) {
    Learn(in);
  } else {
    governor_ = Governor(config_.governor, in.dq_rad_s);
    started_ = true;
  }
  q_previous_rad_ = in.q_rad;
  dq_previous_rad_s_ = in.dq_rad_s;

  const State start = PredictAcrossLatency(in);
  const JointVector target = TargetVelocity(start, Taylor(in.zeta_next, latency_s_), in);
  const bool follows = governor_.Update(target, in.period_s);
  return ControlTorque(start, follows, in);
}

void RobustLaw::Learn(const LawInput& in) {
  // The older torque held for the first L; over missed ticks the newer one went on.
  const double share_of_old = std::min(1.0, latency_s_ / in.elapsed_s);
  const JointVector tau_mean_Nm = share_of_old * tau_before_Nm_ + (1.0 - share_of_old) * tau_committed_Nm_;
  const AppliedInterval interval{q_previous_rad_, dq_previous_rad_s_, in.q_rad,
                                 in.dq_rad_s,     tau_mean_Nm,        in.elapsed_s};
  const TorqueResidual residual = ResidualOf(arm_, theta_hat_, interval);
  const AdaptationKind kind = config_.adaptation.kind;
  if (kind == AdaptationKind::kKalman || kind == AdaptationKind::kBoth) {
    filter_.Update(arm_, residual, theta_hat_);
    Project(config_.projection, arm_, theta_hat_);
  }
  observer_.Update(residual.z_Nm);
}

// Where the joints will be when this tick's torque takes effect: L later, under the torque already committed.
RobustLaw::State RobustLaw::PredictAcrossLatency(const LawInput& in) const {
  if (latency_s_ <= 0.0) return {in.q_rad, in.dq_rad_s};
  JointVector ddq = JointVector::Zero(arm_.dof());
  JointVector q_mid = in.q_rad;
  JointVector dq_mid = in.dq_rad_s;
  for (int iteration = 0; iteration < 3; ++iteration) {
    const PlanarArm::Posture at = arm_.At(q_mid);
    const JointVector bias = arm_.Bias(at, dq_mid, theta_hat_) + observer_.d_hat_Nm();
    ddq = arm_.Inertia(at, theta_hat_).llt().solve(tau_committed_Nm_ - bias);
    q_mid = in.q_rad + (0.5 * latency_s_) * (in.dq_rad_s + (0.25 * latency_s_) * ddq);
    dq_mid = in.dq_rad_s + (0.5 * latency_s_) * ddq;
  }
  return {in.q_rad + latency_s_ * in.dq_rad_s + (0.5 * latency_s_ * latency_s_) * ddq,
          in.dq_rad_s + latency_s_ * ddq};
}

// dq_r(q+, zeta+) of (1.5) at the end of the period, where q+ = q + h (dq + dq_r) / 2 itself depends on dq_r.
JointVector RobustLaw::TargetVelocity(const State& from, const Zeta& zeta_next, const LawInput& in) const {
  const auto reference_at = [&](const JointVector& q) {
    return ReferenceVelocity(config_.reference, config_.pseudoinverse, config_.subtask, arm_, q, zeta_next,
                             in.synced);
  };
  const double h = in.period_s;
  const JointVector q_coasting = from.q_rad + h * from.dq_rad_s;
  JointVector target = reference_at(q_coasting);
  for (int iteration = 0; iteration < 2; ++iteration) {
    const bool reachable =
        (target - from.dq_rad_s).cwiseAbs().maxCoeff() <= governor_.acceleration_limit_rad_s2() * h;
    target =
        reference_at(reachable ? JointVector(from.q_rad + (0.5 * h) * (from.dq_rad_s + target)) : q_coasting);
  }
  return target;
}

JointVector RobustLaw::ControlTorque(const State& from, bool follows, const LawInput& in) {
  const double h = in.period_s;
  const JointVector& dq = from.dq_rad_s;
  const JointVector dq_mid = follows ? JointVector(0.5 * (dq + governor_.end_rad_s())) : dq;
  // q at mid-period: along the mean of dq and dq_mid, or along dq.
  const double mid_weight = follows ? 0.25 : 0.0;
  const JointVector q_mid = from.q_rad + h * ((0.5 - mid_weight) * dq + mid_weight * dq_mid);
  const PlanarArm::Posture at = arm_.At(q_mid);
  const JointVector dq_r = 0.5 * (governor_.start_rad_s() + governor_.end_rad_s());
  // (1.6) by exact difference.
  const JointVector ddq_r = (governor_.end_rad_s() - governor_.start_rad_s()) / h;

  // (1.2) with s at the end of the step: H (s+ - s)/h + (K_s + J'K_x J) s+ + K_r sgn(s+) = 0.
  const JointVector s = dq - governor_.start_rad_s();
  H_hat_ = arm_.Inertia(at, theta_hat_);
  const JacobianMatrix J = arm_.Jacobian(at);
  JointMatrix A = J.transpose() * config_.gains.K_x_Ns_m.asDiagonal() * J;
  A.diagonal() += config_.gains.K_s_Nms_rad;
  A = H_hat_ + h * A;
  const JointVector s_next =
      MinimizeWithL1(config_.implicit_control, A, H_hat_ * s, h * config_.gains.K_r_Nm);

  const RegressorMatrix Y = arm_.Regressor(at, dq_mid, dq_r, ddq_r);
  JointVector u = Y.lazyProduct(theta_hat_) + H_hat_ * (s_next - s) / h + observer_.d_hat_Nm();

  const AdaptationKind kind = config_.adaptation.kind;
  if (kind == AdaptationKind::kGradient || kind == AdaptationKind::kBoth) {
    GradientStep(config_.adaptation, Y, s, h, theta_hat_);  // (1.8)
    Project(config_.projection, arm_, theta_hat_);
  }
  return u;
}

void RobustLaw::Applied(const JointVector& wanted_Nm, const JointVector& sent_Nm) {
  if (sent_Nm != wanted_Nm) governor_.Shift(period_s_ * H_hat_.llt().solve(sent_Nm - wanted_Nm));
  tau_before_Nm_ = tau_committed_Nm_;
  tau_committed_Nm_ = sent_Nm;
}

}  // namespace armada
