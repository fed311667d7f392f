#include "firmware/core/stop_law.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace armada {
namespace {

// -K s at the end of the period: H (s+ - s) / h = -K s+. Explicit where theta_hat is of no physical arm.
JointVector ImplicitFeedback(const JointMatrix& H_hat, const JointVector& K_Nms_rad, const JointVector& s,
                             double h_s) {
  JointMatrix A = H_hat;
  A.diagonal() += h_s * K_Nms_rad;
  const auto factor = A.llt();
  const bool physical = H_hat.allFinite() && H_hat.llt().info() == Eigen::Success;
  if (!physical || factor.info() != Eigen::Success) return -K_Nms_rad.cwiseProduct(s);
  const JointVector s_next = factor.solve(H_hat * s);
  return H_hat * (s_next - s) / h_s;
}

// Y(q, dq, dq_r, ddq_r) theta_hat + feedback on s.
JointVector TorqueTo(const PlanarArm& arm, const JointVector& K_Nms_rad, const StopLawInput& in,
                     const JointVector& s, const JointVector& ddq_r_rad_s2) {
  if (!in.theta_hat.allFinite()) return -K_Nms_rad.cwiseProduct(s);
  const PlanarArm::Posture at = arm.At(in.q_rad);
  const JointVector at_rest = JointVector::Zero(in.q_rad.size());
  const RegressorMatrix Y = arm.Regressor(at, at_rest, at_rest, ddq_r_rad_s2);
  return Y.lazyProduct(in.theta_hat) +
         ImplicitFeedback(arm.Inertia(at, in.theta_hat), K_Nms_rad, s, in.period_s);
}

}  // namespace

JointVector DampingTorque(const PlanarArm& arm, const JointVector& K_Nms_rad, const StopLawInput& in) {
  return TorqueTo(arm, K_Nms_rad, in, in.dq_rad_s, JointVector::Zero(in.q_rad.size()));
}

JointVector HoldLaw::Torque(const PlanarArm& arm, const JointVector& K_s_Nms_rad, const StopLawInput& in) {
  if (elapsed_s_ < 0.0) {
    elapsed_s_ = 0.0;
    dq_start_rad_s_ = in.dq_rad_s;
    q_hold_rad_.resize(0);
  }
  const double ramp_s = config_.stop_ramp_s;
  const double left = std::max(0.0, 1.0 - elapsed_s_ / ramp_s);
  const bool slow = in.dq_rad_s.cwiseAbs().maxCoeff() < config_.hold_capture_rad_s;
  const bool over = elapsed_s_ > ramp_s && (slow || elapsed_s_ > config_.hold_capture_max_s);
  if (q_hold_rad_.size() == 0 && over) q_hold_rad_ = in.q_rad;

  JointVector s = in.dq_rad_s - left * dq_start_rad_s_;
  if (q_hold_rad_.size() > 0) s += config_.hold_rate_1_s * (in.q_rad - q_hold_rad_);
  const JointVector braking =
      left > 0.0 ? JointVector(-dq_start_rad_s_ / ramp_s) : JointVector(JointVector::Zero(in.q_rad.size()));
  elapsed_s_ += in.period_s;
  return TorqueTo(arm, K_s_Nms_rad, in, s, braking);
}

}  // namespace armada
