#pragma once

#include "firmware/core/control_config.h"

namespace armada {

/// The local law (1.2), (1.5), (1.8) for a sampled, saturated, delayed arm. One tick:
///   wanted = law.Torque(input);  sent = limit(wanted);  law.Applied(wanted, sent);
/// Steps and their reasons: docs/equations.md.
class RobustLaw {
 public:
  /// `theta_hat` is projected first. `sample_to_torque_s` is the delay L that is compensated, below one
  /// period.
  RobustLaw(const ControlConfig& config, const PlanarArm& arm, const ParameterVector& theta_hat,
            double sample_to_torque_s);

  /// Torque wanted over the next period, n components, not limited.
  JointVector Torque(const LawInput& in);

  /// The torque that is really sent in place of `wanted_Nm`: anti-windup now, adaptation in the next tick.
  void Applied(const JointVector& wanted_Nm, const JointVector& sent_Nm);

  const ParameterVector& theta_hat() const { return theta_hat_; }
  const JointVector& d_hat_Nm() const { return observer_.d_hat_Nm(); }

 private:
  struct State {
    JointVector q_rad;
    JointVector dq_rad_s;
  };
  void Learn(const LawInput& in);
  State PredictAcrossLatency(const LawInput& in) const;
  JointVector TargetVelocity(const State& from, const Zeta& zeta_next, const LawInput& in) const;
  JointVector ControlTorque(const State& from, bool follows, const LawInput& in);

  ControlConfig config_;
  PlanarArm arm_;
  double latency_s_;
  ParameterVector theta_hat_;
  ParameterFilter filter_;
  DisturbanceObserver observer_;
  Governor governor_;
  bool started_ = false;
  JointVector q_previous_rad_, dq_previous_rad_s_;
  JointVector tau_committed_Nm_;  ///< on its way to, or at, the drives
  JointVector tau_before_Nm_;     ///< in force until that one took over
  JointMatrix H_hat_;             ///< of this tick, for anti-windup
  double period_s_ = 0.0;
};

}  // namespace armada
