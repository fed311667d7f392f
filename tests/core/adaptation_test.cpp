#include "firmware/core/adaptation.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "tests/core/paper_setting.h"
#include "tests/support/random_arms.h"

namespace armada {
namespace {

// One interval of the plant under constant torque.
AppliedInterval Advance(PlanarPlant& plant, const JointVector& tau_Nm, double h_s, int steps = 1) {
  AppliedInterval interval{
      FromPlant(plant, plant.q_rad), FromPlant(plant, plant.dq_rad_s), {}, {}, tau_Nm, h_s};
  for (int i = 0; i < steps; ++i) plant.Step(ToPlant(tau_Nm), h_s / steps);
  interval.q_end_rad = FromPlant(plant, plant.q_rad);
  interval.dq_end_rad_s = FromPlant(plant, plant.dq_rad_s);
  return interval;
}

PlanarPlant RandomPlant(RandomArms& random, const PlanarArm& arm) {
  PlanarPlant plant(arm.config());
  plant.q_rad = ToPlant(random.Numbers(arm.dof(), 3.0));
  plant.dq_rad_s = ToPlant(random.Numbers(arm.dof(), 2.0));
  return plant;
}

// The midpoint rule leaves an error of second order in the interval's length.
TEST(TorqueResidual, VanishesForTrueParametersAsTheIntervalShrinks) {
  RandomArms random(1);
  for (const PlanarArm& arm : random.AllKinds(3)) {
    const PlanarPlant start = RandomPlant(random, arm);
    const JointVector tau_Nm = random.Numbers(arm.dof(), 20.0);
    const auto residual = [&](double h_s) {
      PlanarPlant plant = start;
      return ResidualOf(arm, arm.Theta(), Advance(plant, tau_Nm, h_s)).z_Nm.norm();
    };
    EXPECT_LT(residual(1e-4), 1e-3);
    if (arm.dof() > 1) {  // for one joint without gravity the rule is exact
      EXPECT_NEAR(residual(2e-3) / residual(1e-3), 4.0, 0.5);
    }
  }
}

TEST(TorqueResidual, IsTheWrongParametersTorque) {
  RandomArms random(2);
  for (const PlanarArm& arm : random.AllKinds(3)) {
    PlanarPlant plant = RandomPlant(random, arm);
    const AppliedInterval interval = Advance(plant, random.Numbers(arm.dof(), 20.0), 1e-4);
    ParameterVector theta_hat = 1.3 * arm.Theta();
    const TorqueResidual residual = ResidualOf(arm, theta_hat, interval);
    const JointVector ddq = (interval.dq_end_rad_s - interval.dq_start_rad_s) / interval.h_s;
    const JointVector expected =
        arm.Regressor(residual.at, residual.dq_mid_rad_s, residual.dq_mid_rad_s, ddq) * theta_hat -
        interval.tau_Nm;
    EXPECT_LT((residual.z_Nm - expected).norm(), 1e-8 * (1.0 + expected.norm()));
  }
}

TEST(TorqueResidual, IsMinusADisturbanceOnTheTorque) {
  RandomArms random(3);
  const PlanarArm arm(PaperArm(6));
  PlanarPlant plant = RandomPlant(random, arm);
  const JointVector d_Nm{{10.0, -20.0, 30.0}};
  const JointVector tau_Nm = random.Numbers(3, 20.0);
  AppliedInterval interval = Advance(plant, tau_Nm - d_Nm, 1e-4);
  interval.tau_Nm = tau_Nm;  // what the board believes
  EXPECT_LT((ResidualOf(arm, arm.Theta(), interval).z_Nm + d_Nm).norm(), 1e-3);
}

class LearningTest : public testing::Test {
 protected:
  // 20 s of rich torque on the true arm, with damping so that it does not spin up, learned from at 100 Hz.
  static ParameterVector Learn(const PlanarArm& arm, ParameterFilter& filter) {
    PlanarPlant plant(arm.config());
    ParameterVector theta_hat = ParameterVector::Constant(arm.parameter_count(), 3.0);
    for (int a = 0; a < arm.dof(); ++a) theta_hat[arm.InertiaIndex(a, a)] = 10.0;
    Project(ProjectionConfig{}, arm, theta_hat);
    constexpr double kH_s = 0.01;
    for (int k = 0; k < 2000; ++k) {
      const double t_s = k * kH_s;
      JointVector tau_Nm(arm.dof());
      for (int i = 0; i < arm.dof(); ++i) {
        const double w = 2.0 + 1.3 * i;
        tau_Nm[i] = 60.0 * std::sin(w * t_s) + 40.0 * std::cos(2.7 * w * t_s + i) -
                    8.0 * plant.dq_rad_s[static_cast<size_t>(i)];
      }
      const AppliedInterval interval = Advance(plant, tau_Nm, kH_s, 10);
      filter.Update(arm, ResidualOf(arm, theta_hat, interval), theta_hat);
      Project(ProjectionConfig{}, arm, theta_hat);
    }
    return theta_hat;
  }
};

TEST_F(LearningTest, FilterFindsTheParametersOfThePapersArms) {
  for (int id = 1; id <= 7; ++id) {
    for (const double gravity_m_s2 : {0.0, 9.81}) {
      PlanarArmConfig config = PaperArm(id);
      config.gravity_m_s2 = gravity_m_s2;
      const PlanarArm arm(config);
      AdaptationConfig adaptation;
      adaptation.torque_deviation_Nm = 1.0;
      ParameterFilter filter(adaptation, arm);
      const ParameterVector theta_hat = Learn(arm, filter);
      EXPECT_LT((theta_hat - arm.Theta()).norm(), 0.02 * arm.Theta().norm())
          << "arm " << id << ", gravity " << gravity_m_s2 << ": " << theta_hat.transpose() << " for "
          << arm.Theta().transpose();
    }
  }
}

TEST(ParameterFilter, CovarianceStaysSymmetricAndPositiveDefinite) {
  RandomArms random(4);
  for (const PlanarArm& arm : random.AllKinds(1)) {
    PlanarPlant plant = RandomPlant(random, arm);
    ParameterFilter filter(AdaptationConfig{}, arm);
    EXPECT_TRUE(
        filter.P().isApprox(9.0 * ParameterMatrix::Identity(arm.parameter_count(), arm.parameter_count())));
    ParameterVector theta_hat = arm.Theta();
    for (int k = 0; k < 300; ++k) {
      const AppliedInterval interval = Advance(plant, random.Numbers(arm.dof(), 100.0), 0.01, 10);
      filter.Update(arm, ResidualOf(arm, theta_hat, interval), theta_hat);
      Project(ProjectionConfig{}, arm, theta_hat);
      const ParameterMatrix& P = filter.P();
      ASSERT_EQ((P - P.transpose()).cwiseAbs().maxCoeff(), 0.0);
      ASSERT_GT(Eigen::MatrixXd(P).selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0.0);
    }
  }
}

// Against the textbook update with every matrix written out.
TEST(ParameterFilter, UpdateIsTheKalmanFilters) {
  RandomArms random(5);
  for (const PlanarArm& arm : random.AllKinds(2)) {
    PlanarPlant plant = RandomPlant(random, arm);
    const AdaptationConfig config;
    ParameterFilter filter(config, arm);
    ParameterVector theta_hat = arm.Theta();
    const Eigen::Index count = arm.parameter_count();
    Eigen::MatrixXd P = 9.0 * Eigen::MatrixXd::Identity(count, count);
    for (int k = 0; k < 5; ++k) {
      const TorqueResidual residual =
          ResidualOf(arm, theta_hat, Advance(plant, random.Numbers(arm.dof(), 50.0), 0.01, 10));
      const Eigen::MatrixXd Y = arm.Regressor(residual.at, residual.dq_mid_rad_s, residual.dq_mid_rad_s,
                                              residual.predicted_ddq_rad_s2);
      const Eigen::MatrixXd R = Eigen::MatrixXd::Identity(arm.dof(), arm.dof()) * (40.0 * 40.0 / 3.0);
      const Eigen::MatrixXd K = P * Y.transpose() * (Y * P * Y.transpose() + R).inverse();
      const Eigen::VectorXd expected = theta_hat - K * residual.z_Nm;
      P = (Eigen::MatrixXd::Identity(count, count) - K * Y) * P +
          1e-5 * Eigen::MatrixXd::Identity(count, count);
      filter.Update(arm, residual, theta_hat);
      EXPECT_LT((theta_hat - expected).norm(),
                1e-5 * (1.0 + expected.norm()));  // 40 / sqrt(3) is stated with 5 digits
      EXPECT_LT((filter.P() - P).norm(), 1e-4);
    }
  }
}

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
