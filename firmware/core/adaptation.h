#pragma once

#include "firmware/core/projection.h"

namespace armada {

enum class AdaptationKind {
  kNone,      ///< theta_hat stays at its start
  kKalman,    ///< extended Kalman filter on theta
  kGradient,  ///< (1.8): d theta_hat/dt = -T Y' s
  kBoth,
};

struct AdaptationConfig {
  AdaptationKind kind = AdaptationKind::kKalman;
  double torque_deviation_Nm =
      23.094;  ///< 40 / sqrt(3): standard deviation of a disturbance uniform in +-40 N m
  double initial_deviation = 3.0;
  double drift_variance = 1e-5;
  double gradient_T = 0.1;
  double gradient_step_max = 0.5;

  template <class Visitor>
  void Visit(Visitor& parameter) {
    parameter({"kind", "", 0, 0, "adaptation of theta_hat: none, kalman, gradient (1.8), both"}, kind);
    parameter({"torque_deviation_Nm", "N m", 1e-6, 1e5,
               "Kalman: standard deviation of what disturbs a joint's torque over a tick"},
              torque_deviation_Nm);
    parameter({"initial_deviation", "kg m^2", 1e-6, 1e4, "Kalman: standard deviation of theta_hat's start"},
              initial_deviation);
    parameter({"drift_variance", "kg^2 m^4", 0, 1, "Kalman: variance added to each parameter a tick"},
              drift_variance);
    parameter({"gradient_T", "", 0, 1e3, "T of (1.8)"}, gradient_T);
    parameter({"gradient_step_max", "kg m^2", 0, 1e3,
               "largest change of theta_hat by the gradient in a tick; 0: no bound"},
              gradient_step_max);
  }
};

/// What happened over one tick: the joint states at its ends and the torque that was applied between.
struct AppliedInterval {
  JointVector q_start_rad, dq_start_rad_s;
  JointVector q_end_rad, dq_end_rad_s;
  JointVector tau_Nm;  ///< mean torque over the tick, as limited
  double h_s = 0.0;
};

/// Difference between what the torque did and what theta_hat predicts, in torque units:
/// H_hat (Ddq/h) + C_hat dq + g_hat - u at the interval's midpoint, with what is needed to learn from it.
struct TorqueResidual {
  PlanarArm::Posture at;
  JointVector dq_mid_rad_s;
  JointVector predicted_ddq_rad_s2;  ///< a_p = H_hat^-1 (u - C_hat dq - g_hat)
  JointVector z_Nm;                  ///< H_hat (Ddq/h - a_p)
};
TorqueResidual ResidualOf(const PlanarArm& arm, const ParameterVector& theta_hat,
                          const AppliedInterval& interval);

/// Kalman filter on theta from the torque actually applied (ALGORITHM: step 1). The regressor is taken at the
/// predicted acceleration, not the measured one: no errors-in-variables bias, and saturation cannot wind it
/// up.
class ParameterFilter {
 public:
  ParameterFilter(const AdaptationConfig& config, const PlanarArm& arm);

  /// Corrects theta_hat (not projected) by one tick's residual.
  void Update(const PlanarArm& arm, const TorqueResidual& residual, ParameterVector& theta_hat);

  /// Covariance of theta_hat.
  const ParameterMatrix& P() const { return P_; }

 private:
  AdaptationConfig config_;
  ParameterMatrix P_;
};

/// One explicit Euler step of (1.8), bounded in length.
void GradientStep(const AdaptationConfig& config, const RegressorMatrix& Y, const JointVector& s, double h_s,
                  ParameterVector& theta_hat);

}  // namespace armada
