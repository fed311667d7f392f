#pragma once

#include "firmware/core/control_config.h"

namespace armada {

/// The local law as printed: (1.2) with (1.5), (1.6) and (1.8), explicit Euler, undamped J#, sgn. Kept for
/// comparison and teaching; docs/equations.md says where it fails on a sampled arm. Its torque may be
/// non-finite at a singularity.
class PaperLaw {
 public:
  PaperLaw(const ControlConfig& config, const PlanarArm& arm, const ParameterVector& theta_hat)
      : config_(config), arm_(arm), theta_hat_(theta_hat) {}

  JointVector Torque(const LawInput& in);

  const ParameterVector& theta_hat() const { return theta_hat_; }

 private:
  ControlConfig config_;
  PlanarArm arm_;
  ParameterVector theta_hat_;
};

}  // namespace armada
