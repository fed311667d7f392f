#pragma once

#include "firmware/core/control_config.h"

namespace armada {

/// The local law (1.2), (1.5), (1.8) for a sampled, saturated, delayed arm. One tick:
///   wanted = law.Torque(input);  sent = limit(wanted);  law.Applied(wanted, sent);
/// Steps and their reasons: docs/equations.md.
class RobustLaw {
 public:
  /// `theta_hat` is projected first; `torque_limit_Nm` is what may be sent, n components.
  /// `sample_to_torque_s` is the delay L that is compensated, below one period. `P_theta` is the covariance
  /// of theta_hat, p x p; empty: adaptation.initial_deviation.
  RobustLaw(const ControlConfig& config, const PlanarArm& arm, const ParameterVector& theta_hat,
            const JointVector& torque_limit_Nm, double sample_to_torque_s,
            const ParameterMatrix& P_theta = {});

  /// Torque wanted over the next period, n components, not limited.
  JointVector Torque(const LawInput& in);

  /// The torque that is really sent in place of `wanted_Nm`: anti-windup now, adaptation in the next tick.
  void Applied(const JointVector& wanted_Nm, const JointVector& sent_Nm);

  const ParameterVector& theta_hat() const { return theta_hat_; }
  /// dq_r of (1.5) for the start of this tick's period, before the governor.
  const JointVector& dq_r_rad_s() const { return dq_r_start_rad_s_; }
  const JointVector& d_hat_Nm() const { return filter_.d_hat_Nm(); }
  /// Covariance of theta_hat, p x p.
  ParameterMatrix P_theta() const { return filter_.P_theta(); }

 private:
  void Estimate(const LawInput& in);
  JointState PredictAcrossLatency() const;
  Approach ApproachFrom(const JointState& from, const Zeta& zeta_next) const;
  JointVector TargetVelocity(const JointState& from, const Zeta& zeta_next, const LawInput& in) const;
  JointVector ControlTorque(const JointState& from, bool follows, const LawInput& in);

  ControlConfig config_;
  PlanarArm arm_;
  JointVector torque_limit_Nm_;
  double latency_s_;
  ParameterVector theta_hat_;
  AugmentedFilter filter_;
  Governor governor_;
  bool started_ = false;
  JointVector dq_r_start_rad_s_, dq_r_end_rad_s_;
  JointVector tau_committed_Nm_;  ///< on its way to, or at, the drives
  JointVector tau_before_Nm_;     ///< in force until that one took over
  JointMatrix H_hat_;             ///< of this tick, for anti-windup
  double period_s_ = 0.0;
};

}  // namespace armada
