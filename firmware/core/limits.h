#pragma once

#include "firmware/core/types.h"

namespace armada {

/// Every torque command passes here last: limited joint by joint. One that is not finite is never sent: zero
/// torque in its place.
class TorqueGate {
 public:
  explicit TorqueGate(const JointVector& torque_limit_Nm) : limit_Nm_(torque_limit_Nm) {}

  JointVector Update(const JointVector& wanted_Nm) {
    finite_ = wanted_Nm.allFinite();
    if (!finite_) return JointVector::Zero(limit_Nm_.size());
    JointVector sent = wanted_Nm.cwiseMax(-limit_Nm_).cwiseMin(limit_Nm_);
    saturated_ = sent != wanted_Nm;
    if (saturated_) ++saturated_ticks_;
    return sent;
  }

  /// Of the last command.
  bool finite() const { return finite_; }
  bool saturated() const { return saturated_; }
  int saturated_ticks() const { return saturated_ticks_; }

 private:
  JointVector limit_Nm_;
  bool finite_ = true;
  bool saturated_ = false;
  int saturated_ticks_ = 0;
};

}  // namespace armada
