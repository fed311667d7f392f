#include "firmware/can/feedback_step.h"

#include <gtest/gtest.h>

#include <numbers>
#include <string_view>

#include "firmware/can/make_drive.h"

namespace armada {
namespace {

JointDriveConfig Joint(DriveProfile profile) {
  JointDriveConfig joint{.profile = profile, .node_id = 1, .gear_ratio = 8.0, .torque_limit_Nm = 10.0};
  joint.mit.master_id = 2;
  return joint;
}

// What one code of the drive's answer means, by the tables that the DBC files are made of.
double ScaleOf(const JointDriveConfig& joint, std::string_view signal_name) {
  for (const CanMessage& message : MessagesOf(joint)) {
    if (!message.from_drive) continue;
    for (const CanSignal& signal : message.signals) {
      if (signal.name == signal_name) return signal.scale;
    }
  }
  ADD_FAILURE() << "no signal " << signal_name;
  return 0.0;
}

TEST(FeedbackStep, OfMitFramesIsOneCodeBehindTheGear) {
  for (const DriveProfile profile :
       {DriveProfile::kMiniCheetah, DriveProfile::kCubeMars, DriveProfile::kDamiao}) {
    const JointDriveConfig joint = Joint(profile);
    EXPECT_DOUBLE_EQ(FeedbackStepOf(joint).position_rad, ScaleOf(joint, "position") / 8.0);
    EXPECT_DOUBLE_EQ(FeedbackStepOf(joint).velocity_rad_s, ScaleOf(joint, "velocity") / 8.0);
  }
}

TEST(FeedbackStep, OfACia402DriveIsItsUnitBehindTheGear) {
  JointDriveConfig joint = Joint(DriveProfile::kCia402);
  joint.cia402.counts_per_turn = 4096.0;
  joint.cia402.velocity_per_turn_s = 60.0;  // rpm
  EXPECT_DOUBLE_EQ(FeedbackStepOf(joint).position_rad, 2.0 * std::numbers::pi / 4096.0 / 8.0);
  EXPECT_DOUBLE_EQ(FeedbackStepOf(joint).velocity_rad_s, 2.0 * std::numbers::pi / 60.0 / 8.0);
}

TEST(FeedbackStep, OfFloatingPointNumbersIsNone) {
  for (const DriveProfile profile :
       {DriveProfile::kODriveCanSimple, DriveProfile::kODriveCanSimpleV05, DriveProfile::kMoteus}) {
    EXPECT_EQ(FeedbackStepOf(Joint(profile)).position_rad, 0.0);
    EXPECT_EQ(FeedbackStepOf(Joint(profile)).velocity_rad_s, 0.0);
  }
}

}  // namespace
}  // namespace armada
