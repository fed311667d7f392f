#include "firmware/core/adaptation.h"

#include <gtest/gtest.h>

#include "tests/core/paper_setting.h"
#include "tests/support/random_arms.h"

namespace armada {
namespace {

TEST(GradientStep, IsOneEulerStepOf1_8) {
  RandomArms random(6);
  const PlanarArm arm(PaperArm(6));
  AdaptationConfig config;
  config.gradient_step_max = 0.0;
  const RegressorMatrix Y = arm.Regressor(arm.At(random.Numbers(3, 5.0)), random.Numbers(3, 2.0),
                                          random.Numbers(3, 2.0), random.Numbers(3, 10.0));
  const JointVector s = random.Numbers(3, 1.0);
  ParameterVector theta_hat = arm.Theta();
  GradientStep(config, Y, s, 0.01, theta_hat);
  EXPECT_LT((theta_hat - (arm.Theta() - 0.01 * 0.1 * Y.transpose() * s)).norm(), 1e-14);
}

TEST(GradientStep, IsBoundedInLengthNotInDirection) {
  RandomArms random(7);
  const PlanarArm arm(PaperArm(6));
  AdaptationConfig config;
  config.gradient_step_max = 0.5;
  const RegressorMatrix Y = arm.Regressor(arm.At(random.Numbers(3, 5.0)), random.Numbers(3, 2.0),
                                          random.Numbers(3, 2.0), random.Numbers(3, 10.0));
  const JointVector s = random.Numbers(3, 1e4);
  ParameterVector theta_hat = arm.Theta();
  GradientStep(config, Y, s, 0.01, theta_hat);
  const ParameterVector step = theta_hat - arm.Theta();
  EXPECT_NEAR(step.norm(), 0.5, 1e-9);
  EXPECT_LT((step.normalized() + ParameterVector(Y.transpose() * s).normalized()).norm(), 1e-9);
}

}  // namespace
}  // namespace armada
