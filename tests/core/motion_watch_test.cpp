#include "firmware/core/motion_watch.h"

#include <gtest/gtest.h>

#include "tests/core/paper_setting.h"

namespace armada {
namespace {

MotionSeen Fine() {
  return {.q_rad = JointVector::Zero(2),
          .error_m = 0.001,
          .sigma_min = 0.5,
          .saturated = false,
          .follows = true,
          .holds = false,
          .synced = true};
}

class Watched : public testing::Test {
 protected:
  CauseSet StepFor(const MotionSeen& seen, double seconds) {
    CauseSet causes;
    for (double t_s = 0.0; t_s < seconds - 1e-9; t_s += kPeriod_s) causes = watch_.Update(seen, kPeriod_s);
    return causes;
  }

  SupervisorConfig config_;
  PlanarArmConfig arm_ = [] {
    PlanarArmConfig arm;
    arm.dof = 2;
    arm.q_min_rad = JointVector::Constant(2, -1.0);
    arm.q_max_rad = JointVector::Constant(2, 1.0);
    return arm;
  }();
  MotionWatch watch_{config_, arm_};
};

TEST_F(Watched, SaturationAndSingularitiesDoNotCountOnTheWayFromAFarStart) {
  MotionSeen far = Fine();
  far.error_m = 1.0;
  far.sigma_min = 0.0;
  far.saturated = true;
  EXPECT_TRUE(StepFor(far, 10.0).empty());
}

TEST_F(Watched, BothCountOnceTheArmFollowsAndLastLongEnough) {
  StepFor(Fine(), config_.following_s + kPeriod_s);
  MotionSeen bad = Fine();
  bad.sigma_min = 0.5 * config_.sigma_min;
  bad.saturated = true;
  bad.error_m = 1.1 * config_.following_error_m;
  EXPECT_TRUE(StepFor(bad, config_.sigma_min_s).empty());
  EXPECT_TRUE(StepFor(bad, 2 * kPeriod_s).Has(Cause::kSingular));
  EXPECT_TRUE(StepFor(bad, config_.saturated_max_s).Has(Cause::kSaturated));
  EXPECT_TRUE(StepFor(Fine(), kPeriod_s).empty());
}

TEST_F(Watched, AnArmThatWasStoppedHasToComeToFollowAnew) {
  StepFor(Fine(), config_.following_s + kPeriod_s);
  MotionSeen held = Fine();
  held.follows = false;
  held.saturated = true;
  EXPECT_TRUE(StepFor(held, 1.0).empty());
  MotionSeen far = Fine();
  far.error_m = 0.5;
  far.saturated = true;
  EXPECT_TRUE(StepFor(far, 1.0).empty());
}

TEST_F(Watched, AnArmThatDriftsWhileItShouldHoldIsForTheBrakes) {
  MotionSeen held = Fine();
  held.follows = false;
  held.holds = true;
  held.q_rad[0] = 0.4;  // where it came to rest
  EXPECT_TRUE(StepFor(held, 10.0).empty());
  held.q_rad[0] = 0.4 + 0.9 * config_.hold_drift_rad;
  EXPECT_TRUE(StepFor(held, 10.0).empty());
  held.q_rad[0] = 0.4 + 1.1 * config_.hold_drift_rad;
  EXPECT_TRUE(StepFor(held, kPeriod_s).Has(Cause::kNotHolding));
  StepFor(Fine(), kPeriod_s);
  EXPECT_TRUE(StepFor(held, 0.9 * config_.hold_settle_s).empty()) << "a new hold";
}

TEST_F(Watched, AJointThatLeavesItsLimitsCountsAndOneThatStartsBeyondThemDoesNot) {
  MotionSeen beyond = Fine();
  beyond.q_rad[1] = 1.0 + 2.0 * config_.joint_limit_margin_rad;
  EXPECT_FALSE(StepFor(beyond, 1.0).Has(Cause::kJointLimit));
  StepFor(Fine(), kPeriod_s);
  MotionSeen near = Fine();
  near.q_rad[1] = 1.0 + 0.5 * config_.joint_limit_margin_rad;
  EXPECT_FALSE(StepFor(near, kPeriod_s).Has(Cause::kJointLimit));
  EXPECT_TRUE(StepFor(beyond, kPeriod_s).Has(Cause::kJointLimit));
}

TEST_F(Watched, LimitsMayBeOnOneSideOnly) {
  for (const double side : {-1.0, 1.0}) {
    PlanarArmConfig arm = arm_;
    (side < 0.0 ? arm.q_max_rad : arm.q_min_rad).resize(0);
    watch_ = MotionWatch(config_, arm);
    StepFor(Fine(), kPeriod_s);
    MotionSeen free = Fine();
    free.q_rad[1] = -100.0 * side;
    EXPECT_TRUE(StepFor(free, kPeriod_s).empty());
    MotionSeen beyond = Fine();
    beyond.q_rad[1] = side * (1.0 + 2.0 * config_.joint_limit_margin_rad);
    EXPECT_TRUE(StepFor(beyond, kPeriod_s).Has(Cause::kJointLimit));
  }
}

}  // namespace
}  // namespace armada
