#pragma once

#include "firmware/core/planar_arm.h"
#include "firmware/core/supervisor.h"

namespace armada {

/// What the laws of HOLD and SAFE_STOP see: joints and the estimated dynamics, neither network nor Jacobian.
struct StopLawInput {
  JointVector q_rad;
  JointVector dq_rad_s;
  ParameterVector theta_hat;  ///< not finite: it is left out
  double period_s = 0.0;
};

/// Torque that damps the joints' motion and carries their weight: -K dq at the end of the period + g_hat(q).
/// K: p values.
JointVector DampingTorque(const PlanarArm& arm, const JointVector& K_Nms_rad, const StopLawInput& in);

/// HOLD: brings the joints to rest over stop_ramp_s, then takes the posture they have and holds it by
/// s = dq + hold_rate (q - q_hold), with K_s on s and g_hat(q).
class HoldLaw {
 public:
  explicit HoldLaw(const SupervisorConfig& config) : config_(config) {}

  /// The next torque is the first of a new hold.
  void Restart() { elapsed_s_ = -1.0; }

  JointVector Torque(const PlanarArm& arm, const JointVector& K_s_Nms_rad, const StopLawInput& in);

  bool holds_posture() const { return elapsed_s_ >= 0.0 && q_hold_rad_.size() > 0; }

 private:
  SupervisorConfig config_;
  double elapsed_s_ = -1.0;  ///< since the start of the hold; negative: not started
  JointVector dq_start_rad_s_;
  JointVector q_hold_rad_;  ///< empty until taken
};

}  // namespace armada
