#include "firmware/core/governor.h"

#include <gtest/gtest.h>

#include "tests/core/paper_setting.h"
#include "tests/support/random_arms.h"

namespace armada {
namespace {

constexpr GovernorConfig kGovernor{.acceleration_rad_s2 = 30.0, .speed_rad_s = 15.0};

TEST(Governor, StartsAtTheJointsSpeed) {
  const JointVector dq{{1.0, -2.0}};
  const Governor governor(kGovernor, dq);
  EXPECT_EQ(governor.start_rad_s(), dq);
  EXPECT_EQ(governor.end_rad_s(), dq);
}

TEST(Governor, FollowsATargetWithinItsSlew) {
  Governor governor(kGovernor, JointVector::Zero(2));
  const JointVector target{{0.3, -0.2}};
  EXPECT_TRUE(governor.Update(target, kPeriod_s));
  EXPECT_EQ(governor.start_rad_s(), JointVector::Zero(2));
  EXPECT_EQ(governor.end_rad_s(), target);
  EXPECT_TRUE(governor.Update(target, kPeriod_s));
  EXPECT_EQ(governor.start_rad_s(), target);
}

TEST(Governor, SlewsTowardsADistantTargetAndReachesIt) {
  Governor governor(kGovernor, JointVector::Zero(2));
  const JointVector target{{2.0, -1.0}};
  for (int k = 1; k <= 6; ++k) {
    EXPECT_FALSE(governor.Update(target, kPeriod_s));
    EXPECT_LT((governor.end_rad_s() - k * 0.15 * target).norm(),
              1e-12);  // 30 rad/s^2 on the largest, same direction
  }
  EXPECT_TRUE(governor.Update(target, kPeriod_s));
  EXPECT_EQ(governor.end_rad_s(), target);
}

TEST(Governor, NeverExceedsItsAcceleration) {
  RandomArms random(1);
  Governor governor(kGovernor, random.Numbers(7, 5.0));
  for (int k = 0; k < 500; ++k) {
    const bool follows = governor.Update(random.Numbers(7, 0.6), kPeriod_s);
    const double change = (governor.end_rad_s() - governor.start_rad_s()).cwiseAbs().maxCoeff();
    EXPECT_LE(change, kGovernor.acceleration_rad_s2 * kPeriod_s * (1.0 + 1e-12));
    EXPECT_EQ(follows, change < kGovernor.acceleration_rad_s2 * kPeriod_s * (1.0 - 1e-12));
  }
}

TEST(Governor, AntiWindupShiftsTheEndWithinTheSpeedBound) {
  Governor governor(kGovernor, JointVector::Zero(2));
  governor.Update(JointVector{{0.2, 0.1}}, kPeriod_s);
  governor.Shift(JointVector{{-0.5, 100.0}});
  EXPECT_LT((governor.end_rad_s() - JointVector{{-0.3, 15.0}}).norm(), 1e-12);
  EXPECT_EQ(governor.start_rad_s(), JointVector::Zero(2));
  governor.Update(governor.end_rad_s(), kPeriod_s);  // the next tick begins where the shift left it
  EXPECT_LT((governor.start_rad_s() - JointVector{{-0.3, 15.0}}).norm(), 1e-12);
}

}  // namespace
}  // namespace armada
