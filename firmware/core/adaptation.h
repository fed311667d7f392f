#pragma once

#include "firmware/core/parameter.h"
#include "firmware/core/projection.h"

namespace armada {

enum class AdaptationKind {
  kNone,      ///< theta_hat stays at its start
  kKalman,    ///< extended Kalman filter on theta
  kGradient,  ///< (1.8): d theta_hat/dt = -T Y' s
  kBoth,
};

constexpr auto EnumNames(AdaptationKind) {
  using enum AdaptationKind;
  return std::to_array<EnumName<AdaptationKind>>(
      {{kNone, "none"}, {kKalman, "kalman"}, {kGradient, "gradient"}, {kBoth, "both"}});
}

struct AdaptationConfig {
  AdaptationKind kind = AdaptationKind::kKalman;
  double initial_deviation = 3.0;
  double drift_variance = 1e-5;
  bool second_order = true;
  double gradient_T = 0.1;
  double gradient_step_max = 0.5;

  void Visit(ParameterVisitor& parameter) {
    parameter({"kind", "", 0, 0, "adaptation of theta_hat: none, kalman, gradient (1.8), both"}, kind);
    parameter({"initial_deviation", "kg m^2", 1e-6, 1e4, "Kalman: standard deviation of theta_hat's start"},
              initial_deviation);
    parameter({"drift_variance", "kg^2 m^4", 0, 1, "Kalman: variance added to each parameter a tick"},
              drift_variance);
    parameter({"second_order", "", 0, 1,
               "Kalman: counts as noise what theta's error makes of accelerations not foreseen"},
              second_order);
    parameter({"gradient_T", "", 0, 1e3, "T of (1.8)"}, gradient_T);
    parameter({"gradient_step_max", "kg m^2", 0, 1e3,
               "largest change of theta_hat by the gradient in a tick; 0: no bound"},
              gradient_step_max);
  }
};

/// One explicit Euler step of (1.8), bounded in length.
void GradientStep(const AdaptationConfig& config, const RegressorMatrix& Y, const JointVector& s, double h_s,
                  ParameterVector& theta_hat);

}  // namespace armada
