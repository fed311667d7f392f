#include "firmware/core/robust_law.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace armada {
namespace {

ParameterMatrix CovarianceAtStart(const AdaptationConfig& config, const ParameterMatrix& learned,
                                  Eigen::Index p) {
  if (config.kind != AdaptationKind::kKalman && config.kind != AdaptationKind::kBoth)
    return ParameterMatrix::Zero(p, p);
  if (learned.size() > 0) return learned;
  return ParameterMatrix::Identity(p, p) * (config.initial_deviation * config.initial_deviation);
}

}  // namespace

RobustLaw::RobustLaw(const ControlConfig& config, const PlanarArm& arm, const ParameterVector& theta_hat,
                     const JointVector& torque_limit_Nm, double sample_to_torque_s,
                     const ParameterMatrix& P_theta)
    : config_(config),
      arm_(arm),
      torque_limit_Nm_(torque_limit_Nm),
      latency_s_(sample_to_torque_s),
      theta_hat_(theta_hat),
      filter_(config.sensor, config.disturbance, config.adaptation,
              CovarianceAtStart(config.adaptation, P_theta, theta_hat.size()), arm),
      governor_(config.governor, JointVector::Zero(arm.dof())),
      dq_r_start_rad_s_(JointVector::Zero(arm.dof())),
      tau_committed_Nm_(JointVector::Zero(arm.dof())),
      tau_before_Nm_(JointVector::Zero(arm.dof())) {
  Project(config_.projection, arm_, theta_hat_);
}

JointVector RobustLaw::Torque(const LawInput& in) {
  period_s_ = in.period_s;
  Estimate(in);
  const JointState start = PredictAcrossLatency();
  dq_r_start_rad_s_ = dq_r_end_rad_s_;
  dq_r_end_rad_s_ = TargetVelocity(start, Taylor(in.zeta_next, latency_s_), in);
  const bool follows = governor_.Update(dq_r_end_rad_s_, in.period_s);
  return ControlTorque(start, follows, in);
}

void RobustLaw::Estimate(const LawInput& in) {
  const JointState sample{in.q_rad, in.dq_rad_s};
  if (!started_) {
    filter_.Start(sample);
    governor_ = Governor(config_.governor, in.dq_rad_s);
    dq_r_end_rad_s_ = in.dq_rad_s;
    started_ = true;
    return;
  }
  // The older torque held for the first L; over missed ticks the newer one went on.
  ParameterVector theta_hat = theta_hat_;
  filter_.Update(arm_, {tau_before_Nm_, latency_s_, tau_committed_Nm_}, sample, in.elapsed_s, theta_hat);
  if (!in.adapts) return;
  theta_hat_ = theta_hat;
  Project(config_.projection, arm_, theta_hat_);
}

// Where the joints will be when this tick's torque takes effect: L later, under the torque already committed.
JointState RobustLaw::PredictAcrossLatency() const {
  if (latency_s_ <= 0.0) return filter_.joints();
  return Integrate(arm_, theta_hat_, filter_.joints(), tau_committed_Nm_ - filter_.d_hat_Nm(), latency_s_);
}

// The largest a_b with |H J# n| a_b <= what the joints' torque limits leave, n the direction to x_hat.
Approach RobustLaw::ApproachFrom(const JointState& from, const Zeta& zeta_next) const {
  const ReferenceConfig& config = config_.reference;
  const PlanarArm::Posture at = arm_.At(from.q_rad);
  const JacobianMatrix J = arm_.Jacobian(at);
  const InverseMatrix J_sharp = DampedPseudoinverse(config_.pseudoinverse, J).J_sharp;
  const JointMatrix H_hat = arm_.Inertia(at, theta_hat_);
  const TaskVector e = ClampToReach(config, arm_, zeta_next.x_m) - arm_.Position(at);
  const double error_m = e.norm();
  const TaskVector n = error_m > 0.0 ? TaskVector(e / error_m) : TaskVector(TaskVector::Unit(e.size(), 0));
  const JointVector load_Nm =
      H_hat * (J_sharp * zeta_next.a_m_s2) + arm_.Bias(at, from.dq_rad_s, theta_hat_) + filter_.d_hat_Nm();
  const JointVector spare_Nm =
      torque_limit_Nm_.array() - load_Nm.array().abs() - config_.disturbance.fast_deviation_Nm;
  const JointVector needed_Nms2_m = (H_hat * (J_sharp * n)).cwiseAbs();
  const double braking = config.braking_share * (spare_Nm.array() / needed_Nms2_m.array()).minCoeff();
  return {config.alpha_per_tick / period_s_, std::max(braking, config.braking_min_m_s2),
          config.approach_speed_m_s};
}

// dq_r(q+, zeta+) of (1.5) at the end of the period, where q+ = q + h (dq + dq_r) / 2 itself depends on dq_r.
JointVector RobustLaw::TargetVelocity(const JointState& from, const Zeta& zeta_next,
                                      const LawInput& in) const {
  const double h = in.period_s;
  const Approach approach = ApproachFrom(from, zeta_next);
  JointVector target = from.dq_rad_s;
  bool reachable = true;
  for (int iteration = 0; iteration < config_.reference.iterations; ++iteration) {
    const JointVector dq_end = reachable ? target : from.dq_rad_s;
    target =
        ReferenceVelocity(config_.reference, approach, config_.pseudoinverse, config_.subtask, arm_,
                          from.q_rad + (0.5 * h) * (from.dq_rad_s + dq_end), dq_end,
                          reachable && config_.reference.implicit_pull ? 0.5 * h : 0.0, zeta_next, in.synced);
    reachable = (target - from.dq_rad_s).cwiseAbs().maxCoeff() <= governor_.acceleration_limit_rad_s2() * h;
  }
  return target;
}

JointVector RobustLaw::ControlTorque(const JointState& from, bool follows, const LawInput& in) {
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

  const JointVector s = dq - governor_.start_rad_s();
  H_hat_ = arm_.Inertia(at, theta_hat_);
  const JacobianMatrix J = arm_.Jacobian(at);
  JointMatrix K = J.transpose() * config_.gains.K_x_Ns_m.asDiagonal() * J;
  K.diagonal() += config_.gains.K_s_Nms_rad;
  K *= in.gain_share;
  JointVector feedback_Nm;
  if (config_.implicit_control.on) {
    // (1.2) with s at the end of the step: H (s+ - s)/h + K s+ + K_r sgn(s+) = 0.
    const JointVector s_next =
        MinimizeWithL1(config_.implicit_control, H_hat_ + h * K, H_hat_ * s, h * config_.gains.K_r_Nm);
    feedback_Nm = H_hat_ * (s_next - s) / h;
  } else {
    feedback_Nm = -K * s - config_.gains.K_r_Nm.cwiseProduct(s.cwiseSign());
  }

  const RegressorMatrix Y = arm_.Regressor(at, dq_mid, dq_r, ddq_r);
  const JointVector u = Y.lazyProduct(theta_hat_) + feedback_Nm + filter_.d_hat_Nm();

  const AdaptationKind kind = config_.adaptation.kind;
  if (in.adapts && (kind == AdaptationKind::kGradient || kind == AdaptationKind::kBoth)) {
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
