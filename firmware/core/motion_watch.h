#pragma once

#include "firmware/core/cause.h"
#include "firmware/core/planar_arm.h"
#include "firmware/core/supervisor.h"

namespace armada {

/// What the watch sees of a tick.
struct MotionSeen {
  JointVector q_rad;
  double error_m = 0.0;    ///< |x - x_hat|
  double sigma_min = 0.0;  ///< m/rad
  bool saturated = false;  ///< a joint is at its torque limit
  bool follows = false;    ///< in kRun or kDegraded
  bool holds = false;      ///< in kHold
  bool synced = false;
};

/// Watches the motion of an arm for causes. A start far off may saturate joints and lead through
/// singularities: those count only once the arm has come to follow.
class MotionWatch {
 public:
  MotionWatch(const SupervisorConfig& config, const PlanarArmConfig& arm) : config_(config), arm_(arm) {}

  CauseSet Update(const MotionSeen& seen, double elapsed_s);

 private:
  bool CrossesALimit(const JointVector& q_rad);
  bool LosesItsPosture(const MotionSeen& seen, double elapsed_s);

  SupervisorConfig config_;
  PlanarArmConfig arm_;
  bool following_ = false;
  double near_s_ = 0.0;  ///< for how long the error has been small
  double away_s_ = 0.0;  ///< for how long it has tried to come to follow
  bool was_within_limits_ = false;
  double holding_s_ = 0.0;
  JointVector q_held_rad_;
  double singular_s_ = 0.0;
  double saturated_s_ = 0.0;
};

}  // namespace armada
