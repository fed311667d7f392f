#pragma once

#include "firmware/core/parameter.h"
#include "firmware/core/types.h"

namespace armada {

struct GovernorConfig {
  double acceleration_rad_s2 = 100.0;
  double speed_rad_s = 15.0;

  void Visit(ParameterVisitor& parameter) {
    parameter({"acceleration_rad_s2", "rad/s^2", 1e-2, 1e5,
               "slew of the governed reference velocity, largest joint"},
              acceleration_rad_s2);
    parameter(
        {"speed_rad_s", "rad/s", 1e-2, 1e3, "bound on the governed reference velocity after anti-windup"},
        speed_rad_s);
  }
};

/// Governed reference velocity dq_g: follows the target dq_r(q+, zeta+) of the tick's end at a bounded slew.
/// Its exact difference over the tick replaces the derivative (1.6).
class Governor {
 public:
  Governor(const GovernorConfig& config, const JointVector& dq) : config_(config), start_(dq), end_(dq) {}

  /// Advances one tick towards `target`; false when the slew limit held it back.
  bool Update(const JointVector& target, double h_s) {
    start_ = end_;
    const JointVector change = target - start_;
    const double largest = change.cwiseAbs().maxCoeff();
    const double allowed = config_.acceleration_rad_s2 * h_s;
    const bool follows = largest <= allowed;
    end_ = follows ? target : JointVector(start_ + (allowed / largest) * change);
    return follows;
  }

  /// Anti-windup: the reference moves to what the limited torque will reach.
  void Shift(const JointVector& velocity_change) {
    end_ = (end_ + velocity_change).cwiseMax(-config_.speed_rad_s).cwiseMin(config_.speed_rad_s);
  }

  const JointVector& start_rad_s() const { return start_; }  ///< dq_g at the tick's start
  const JointVector& end_rad_s() const { return end_; }      ///< and at its end
  double acceleration_limit_rad_s2() const { return config_.acceleration_rad_s2; }

 private:
  GovernorConfig config_;
  JointVector start_;
  JointVector end_;
};

}  // namespace armada
