#pragma once

#include "firmware/can/joint_drive_config.h"

namespace armada {

/// Smallest difference that a drive's frames can tell, joint side; 0 where they carry floating-point numbers.
struct FeedbackStep {
  double position_rad = 0.0;
  double velocity_rad_s = 0.0;
};
FeedbackStep FeedbackStepOf(const JointDriveConfig& joint);

}  // namespace armada
