#pragma once

#include <limits>

#include "firmware/app/fleet.h"
#include "host/metrics.h"

namespace armada {

/// What one arm did with its spare joints, tick by tick of the window.
class SubtaskRecord {
 public:
  explicit SubtaskRecord(const ArmEntry& entry) : control_(entry.control), arm_(entry.arm) {}

  /// The joints at a tick, and |e_s| there.
  void Update(const JointVector& q_rad, double error_rad_s);

  /// Fills what `metrics` say of the window about subtask, limits and obstacles.
  void WriteTo(ArmMetrics* metrics) const;

 private:
  ControlConfig control_;
  PlanarArm arm_;
  double error_squares_ = 0.0;
  double posture_squares_ = 0.0;
  double posture_max_rad_ = 0.0;
  double clearance_min_m_ = std::numeric_limits<double>::infinity();
  double limit_margin_min_rad_ = std::numeric_limits<double>::infinity();
  int64_t ticks_ = 0;
};

}  // namespace armada
