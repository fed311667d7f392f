#include "firmware/core/governor.h"

#include <gtest/gtest.h>

#include "tests/support/random_arms.h"

namespace armada {
namespace {

constexpr GovernorConfig kConfig{.acceleration_rad_s2 = 30.0, .speed_rad_s = 15.0};
constexpr double kH_s = 0.01;

TEST(Governor, StartsAtTheJointsSpeed) {
  const JointVector dq{{1.0, -2.0}};
  const Governor governor(kConfig, dq);
  EXPECT_EQ(governor.start_rad_s(), dq);
  EXPECT_EQ(governor.end_rad_s(), dq);
}

TEST(Governor, FollowsATargetWithinItsSlew) {
  Governor governor(kConfig, JointVector::Zero(2));
  const JointVector target{{0.3, -0.2}};
  EXPECT_TRUE(governor.Update(target, kH_s));
  EXPECT_EQ(governor.start_rad_s(), JointVector::Zero(2));
  EXPECT_EQ(governor.end_rad_s(), target);
  EXPECT_TRUE(governor.Update(target, kH_s));
  EXPECT_EQ(governor.start_rad_s(), target);
}

TEST(Governor, SlewsTowardsADistantTargetAndReachesIt) {
  Governor governor(kConfig, JointVector::Zero(2));
  const JointVector target{{2.0, -1.0}};
  for (int k = 1; k <= 6; ++k) {
    EXPECT_FALSE(governor.Update(target, kH_s));
    EXPECT_LT((governor.end_rad_s() - k * 0.15 * target).norm(),
              1e-12);  // 30 rad/s^2 on the largest, same direction
  }
  EXPECT_TRUE(governor.Update(target, kH_s));
  EXPECT_EQ(governor.end_rad_s(), target);
}

TEST(Governor, NeverExceedsItsAcceleration) {
  RandomArms random(1);
  Governor governor(kConfig, random.Numbers(7, 5.0));
  for (int k = 0; k < 500; ++k) {
    const bool follows = governor.Update(random.Numbers(7, 0.6), kH_s);
    const double change = (governor.end_rad_s() - governor.start_rad_s()).cwiseAbs().maxCoeff();
    EXPECT_LE(change, kConfig.acceleration_rad_s2 * kH_s * (1.0 + 1e-12));
    EXPECT_EQ(follows, change < kConfig.acceleration_rad_s2 * kH_s * (1.0 - 1e-12));
  }
}

TEST(Governor, AntiWindupShiftsTheEndWithinTheSpeedBound) {
  Governor governor(kConfig, JointVector::Zero(2));
  governor.Update(JointVector{{0.2, 0.1}}, kH_s);
  governor.Shift(JointVector{{-0.5, 100.0}});
  EXPECT_LT((governor.end_rad_s() - JointVector{{-0.3, 15.0}}).norm(), 1e-12);
  EXPECT_EQ(governor.start_rad_s(), JointVector::Zero(2));
  governor.Update(governor.end_rad_s(), kH_s);  // the next tick begins where the shift left it
  EXPECT_LT((governor.start_rad_s() - JointVector{{-0.3, 15.0}}).norm(), 1e-12);
}

}  // namespace
}  // namespace armada
