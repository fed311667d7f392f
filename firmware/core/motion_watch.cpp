#include "firmware/core/motion_watch.h"

namespace armada {

CauseSet MotionWatch::Update(const MotionSeen& seen, double elapsed_s) {
  const bool near = seen.follows && seen.synced && seen.error_m < config_.following_error_m;
  near_s_ = near ? near_s_ + elapsed_s : 0.0;
  following_ = seen.follows && (following_ || near_s_ > config_.following_s);
  if (!seen.follows) {
    away_s_ = 0.0;
  } else if (seen.synced && !following_) {
    away_s_ += elapsed_s;
  }
  const bool singular = following_ && seen.sigma_min < config_.sigma_min;
  singular_s_ = singular ? singular_s_ + elapsed_s : 0.0;
  // A subtask may take all the torque that there is, as long as the task does not suffer.
  const bool too_weak = following_ && seen.saturated && seen.error_m > config_.following_error_m;
  saturated_s_ = too_weak ? saturated_s_ + elapsed_s : 0.0;

  CauseSet causes;
  causes.Set(Cause::kSingular, singular_s_ > config_.sigma_min_s);
  causes.Set(Cause::kSaturated, saturated_s_ > config_.saturated_max_s);
  causes.Set(Cause::kNotFollowing, !following_ && away_s_ > config_.follow_max_s);
  causes.Set(Cause::kJointLimit, CrossesALimit(seen.q_rad));
  causes.Set(Cause::kNotHolding, LosesItsPosture(seen, elapsed_s));
  return causes;
}

// Whatever the drives say of speeds: an arm that cannot hold is for the brakes.
bool MotionWatch::LosesItsPosture(const MotionSeen& seen, double elapsed_s) {
  holding_s_ = seen.holds ? holding_s_ + elapsed_s : 0.0;
  if (holding_s_ <= config_.hold_settle_s) {
    q_held_rad_ = seen.q_rad;
    return false;
  }
  return (seen.q_rad - q_held_rad_).cwiseAbs().maxCoeff() > config_.hold_drift_rad;
}

// An arm may start beyond a limit, and come back. It may have limits on one side only.
bool MotionWatch::CrossesALimit(const JointVector& q_rad) {
  const double margin_rad = config_.joint_limit_margin_rad;
  const JointVector& min_rad = arm_.q_min_rad;
  const JointVector& max_rad = arm_.q_max_rad;
  const bool within = (min_rad.size() == 0 || (q_rad.array() >= min_rad.array() - margin_rad).all()) &&
                      (max_rad.size() == 0 || (q_rad.array() <= max_rad.array() + margin_rad).all());
  const bool crosses = was_within_limits_ && !within;
  was_within_limits_ = within;
  return crosses;
}

}  // namespace armada
