#pragma once

#include "firmware/core/subtask.h"
#include "host/floor/moving_arm.h"
#include "host/floor/sampled_lqr.h"

namespace armada {

/// The best that held torques can do for an arm that knows itself, its state and the leader: computed torque
/// on the plant itself, with the end effector's velocity at the end of the period from the sampled-data LQR
/// of its error.
class ExactTracking {
 public:
  ExactTracking(const PlanarArmConfig& arm, const SubtaskConfig& subtask, const LeaderPath& leader,
                double period_s);

  /// Torque to be held for a period from `arm.t_s` on, which must be when it takes effect. Spare joints move
  /// by the subtask.
  PlanarPlant::Joints Torque(const MovingArm& arm);

  /// Joint velocity that moves the end effector at `v_m_s` and spare joints by the subtask: (1.5).
  JointVector JointVelocity(const JointVector& q_rad, const TaskVector& v_m_s) const;

 private:
  PlanarArm arm_;
  SubtaskConfig subtask_;
  const LeaderPath* leader_;
  double period_s_;
  ParameterVector theta_;
  SampledLqr lqr_;
  PlanarPlant::Joints tau_Nm_{};  ///< of the last tick: where the search begins
};

}  // namespace armada
