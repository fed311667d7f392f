#pragma once

#include "firmware/core/types.h"

namespace armada {

struct DisturbanceObserverConfig {
  double gain = 0.2;
  double bound_Nm = 40.0;

  template <class Visitor>
  void Visit(Visitor& parameter) {
    parameter(
        {"gain", "1/tick", 0, 1, "share of the torque residual taken into d_hat each tick; 0: no observer"},
        gain);
    parameter({"bound_Nm", "N m", 0, 1e5, "largest disturbance that d_hat may claim, per joint"}, bound_Nm);
  }
};

/// d_hat: slow part of the disturbance d(t) of (1.1), from the torque residual of ResidualOf().
class DisturbanceObserver {
 public:
  DisturbanceObserver(const DisturbanceObserverConfig& config, int dof)
      : config_(config), d_hat_Nm_(JointVector::Zero(dof)) {}

  void Update(const JointVector& z_Nm) {
    d_hat_Nm_ += config_.gain * (-z_Nm - d_hat_Nm_);  // H ddq + C dq + g + d = u, hence d = -z
    d_hat_Nm_ = d_hat_Nm_.cwiseMax(-config_.bound_Nm).cwiseMin(config_.bound_Nm);
  }

  const JointVector& d_hat_Nm() const { return d_hat_Nm_; }

 private:
  DisturbanceObserverConfig config_;
  JointVector d_hat_Nm_;
};

}  // namespace armada
