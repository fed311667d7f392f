#include "firmware/can/feedback_step.h"

#include <numbers>

namespace armada {

FeedbackStep FeedbackStepOf(const JointDriveConfig& joint) {
  constexpr double kTurn_rad = 2.0 * std::numbers::pi;
  switch (joint.profile) {
    case DriveProfile::kMiniCheetah:
    case DriveProfile::kCubeMars:
    case DriveProfile::kDamiao:  // 16 and 12 bits over +- the ranges
      return {2.0 * joint.mit.position_max_rad / 0xFFFF / joint.gear_ratio,
              2.0 * joint.mit.velocity_max_rad_s / 0xFFF / joint.gear_ratio};
    case DriveProfile::kCia402:
      return {kTurn_rad / joint.cia402.counts_per_turn / joint.gear_ratio,
              kTurn_rad / joint.cia402.velocity_per_turn_s / joint.gear_ratio};
    case DriveProfile::kODriveCanSimple:
    case DriveProfile::kODriveCanSimpleV05:
    case DriveProfile::kMoteus:
      break;
  }
  return {};
}

}  // namespace armada
