#pragma once

#include "firmware/core/types.h"

namespace armada {

/// Every torque command passes here last: limited joint by joint, then checked. A command that is not finite
/// is never sent; the gate then gives zero torque and stays shut until the controller is started anew.
class TorqueGate {
 public:
  explicit TorqueGate(const JointVector& torque_limit_Nm) : limit_Nm_(torque_limit_Nm) {}

  JointVector Update(const JointVector& wanted_Nm) {
    if (!wanted_Nm.allFinite()) shut_ = true;
    if (shut_) return JointVector::Zero(limit_Nm_.size());
    JointVector sent = wanted_Nm.cwiseMax(-limit_Nm_).cwiseMin(limit_Nm_);
    if (sent != wanted_Nm) ++saturated_ticks_;
    return sent;
  }

  bool shut() const { return shut_; }
  int saturated_ticks() const { return saturated_ticks_; }

 private:
  JointVector limit_Nm_;
  bool shut_ = false;
  int saturated_ticks_ = 0;
};

}  // namespace armada
