#include "host/subtask_record.h"

#include <algorithm>
#include <cmath>

namespace armada {

void SubtaskRecord::Update(const JointVector& q_rad, double error_rad_s) {
  ++ticks_;
  error_squares_ += error_rad_s * error_rad_s;
  clearance_min_m_ = std::min(clearance_min_m_, ClearanceOf(arm_, q_rad));
  limit_margin_min_rad_ = std::min(limit_margin_min_rad_, LimitMarginOf(arm_, q_rad));
  if (control_.subtask.kind != SubtaskKind::kPosture) return;
  const double distance_rad = PostureDistance(control_.subtask, arm_.config(), q_rad);
  posture_squares_ += distance_rad * distance_rad;
  posture_max_rad_ = std::max(posture_max_rad_, distance_rad);
}

void SubtaskRecord::WriteTo(ArmMetrics* metrics) const {
  const auto rms = [&](double squares) {
    return ticks_ > 0 ? std::sqrt(squares / static_cast<double>(ticks_)) : 0.0;
  };
  const SubtaskConfig& subtask = control_.subtask;
  if (HasSubtask(subtask, arm_)) metrics->subtask_rms_rad_s = rms(error_squares_);
  if (subtask.kind == SubtaskKind::kPosture) {
    metrics->posture = {subtask.joint, subtask.goal_rad, rms(posture_squares_), posture_max_rad_};
  }
  const PlanarArmConfig& arm = arm_.config();
  if (arm.obstacle_count > 0) metrics->clearance = {subtask.avoidance.clearance_m, clearance_min_m_};
  if (arm.q_min_rad.size() > 0 || arm.q_max_rad.size() > 0)
    metrics->limits = {arm.q_min_rad, arm.q_max_rad, limit_margin_min_rad_};
}

}  // namespace armada
