#include "firmware/core/adaptation.h"

namespace armada {

void GradientStep(const AdaptationConfig& config, const RegressorMatrix& Y, const JointVector& s, double h_s,
                  ParameterVector& theta_hat) {
  ParameterVector step = Y.transpose().lazyProduct(s);
  step *= h_s * config.gradient_T;
  const double length = step.norm();
  if (config.gradient_step_max > 0.0 && length > config.gradient_step_max)
    step *= config.gradient_step_max / length;
  theta_hat -= step;
}

}  // namespace armada
