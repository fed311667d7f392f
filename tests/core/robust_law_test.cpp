// The robust law in closed loop with a plant of its own derivation.
#include "firmware/core/robust_law.h"

#include <gtest/gtest.h>

#include "tests/core/closed_loop.h"
#include "tests/core/paper_setting.h"

namespace armada {
namespace {

// Arm `id` at rest with a bent elbow; the estimate starts on the leader, theta_hat at `theta_share` of the
// truth.
ClosedLoop Start(const ArmControllerConfig& config, double theta_share = 1.0) {
  const ParameterVector theta = PlanarArm(config.arm).Theta();
  ClosedLoop loop(config, {PaperLeader(0.0), theta_share * theta}, PaperLeader);
  loop.plant().q_rad = {0.3, 1.2, 0.5};
  return loop;
}

ArmControllerConfig KnownArm(int id) {
  ArmControllerConfig config = PaperController(PaperArm(id));
  config.control.adaptation.kind = AdaptationKind::kNone;
  return config;
}

TEST(RobustLaw, TracksBelowAMillimetreWithKnownParameters) {
  for (int id = 1; id <= 7; ++id) {
    ClosedLoop loop = Start(KnownArm(id));
    loop.RunUntil(5.0);
    loop.StartWindow();
    loop.RunUntil(9.0);
    EXPECT_LT(loop.rms_m(), 0.5e-3) << "arm " << id;
    EXPECT_LT(loop.max_m(), 1e-3) << "arm " << id;
  }
}

TEST(RobustLaw, TracksAsWellWhenTheSampleComesAfterTheTick) {
  ClosedLoop loop = Start(KnownArm(4));
  loop.set_sample_delay_s(0.004);
  loop.RunUntil(5.0);
  loop.StartWindow();
  loop.RunUntil(9.0);
  EXPECT_LT(loop.rms_m(), 0.5e-3);
}

TEST(RobustLaw, ArrivesFromFarAwayWithinItsLimits) {
  for (int id = 1; id <= 7; ++id) {
    ArmControllerConfig config = KnownArm(id);
    ClosedLoop loop = Start(config);
    loop.plant().q_rad = {-2.0, -1.5, 2.0};
    loop.plant().dq_rad_s = {4.0, -3.0, 2.0};
    if (id < 6) loop.plant().q_rad[2] = loop.plant().dq_rad_s[2] = 0.0;
    while (loop.time_s() < 6.0) {
      loop.Tick();
      EXPECT_TRUE(
          (loop.controller().status().tau_Nm.cwiseAbs().array() <= config.torque_limit_Nm.array()).all());
    }
    EXPECT_LT(loop.controller().status().error_m, 2e-3) << "arm " << id;
  }
}

TEST(RobustLaw, LearnsTheParametersWhileTracking) {
  for (const double gravity_m_s2 : {0.0, 9.81}) {
    ArmControllerConfig config = PaperController(PaperArm(6));
    config.arm.gravity_m_s2 = gravity_m_s2;
    ClosedLoop loop = Start(config, 0.6);
    loop.RunUntil(1.0);
    loop.StartWindow();
    loop.RunUntil(2.0);
    const double early_m = loop.rms_m();
    loop.RunUntil(10.0);
    loop.StartWindow();
    loop.RunUntil(14.0);
    EXPECT_LT(loop.rms_m(), 1e-3);
    EXPECT_LT(loop.rms_m(), early_m);
  }
}

TEST(RobustLaw, CompensatesTheLatencyItIsToldOf) {
  const auto rms_m = [](double told_s) {
    ArmControllerConfig config = KnownArm(2);
    config.timing.sample_to_torque_s = told_s;
    ClosedLoop loop = Start(config);
    loop.set_latency_s(0.005);
    loop.RunUntil(5.0);
    loop.StartWindow();
    loop.RunUntil(9.0);
    return loop.rms_m();
  };
  EXPECT_LT(rms_m(0.005), 1e-3);
  EXPECT_GT(rms_m(0.0), 3.0 * rms_m(0.005));
}

TEST(RobustLaw, RemovesAConstantDisturbance) {
  const auto rms_m = [](double drift_Nm) {
    ArmControllerConfig config = KnownArm(3);
    config.control.disturbance.drift_Nm = drift_Nm;
    ClosedLoop loop = Start(config);
    loop.set_disturbance(JointVector{{30.0, -20.0}});
    loop.RunUntil(5.0);
    EXPECT_TRUE(drift_Nm == 0.0 || (loop.controller().d_hat_Nm() - JointVector{{30.0, -20.0}}).norm() < 1.0);
    loop.StartWindow();
    loop.RunUntil(9.0);
    return loop.rms_m();
  };
  EXPECT_LT(rms_m(1.0), 0.1e-3);
  EXPECT_GT(rms_m(0.0), 5.0 * rms_m(1.0));
}

// Over a missed tick the last torque goes on. Taken for what it was, it teaches no disturbance that is not
// there.
TEST(RobustLaw, LearnsNothingFalseFromMissedTicks) {
  for (int id = 1; id <= 7; ++id) {
    ArmControllerConfig config = KnownArm(id);
    config.timing.sample_to_torque_s = 0.008;
    ClosedLoop loop = Start(config);
    loop.RunUntil(5.0);
    double largest_Nm = 0.0;
    for (int k = 0; k < 200; ++k) {
      loop.Tick(/*missed=*/k % 7 == 3);
      largest_Nm = std::max(largest_Nm, loop.controller().d_hat_Nm().cwiseAbs().maxCoeff());
    }
    EXPECT_LT(largest_Nm, 0.02) << "arm " << id;
  }
}

TEST(RobustLaw, BrakesToRestUntilTheEstimateMayBeUsed) {
  ArmControllerConfig config = KnownArm(6);
  config.estimator.sync_ticks = 1000;
  config.control.governor.acceleration_rad_s2 = 30.0;
  ClosedLoop loop = Start(config);
  loop.plant().dq_rad_s = {3.0, -4.0, 5.0};
  loop.RunUntil(0.1);  // at the governor's 30 rad/s^2 for the fastest joint, not at once
  EXPECT_NEAR(loop.Sample().dq_rad_s[2], 5.0 - 30.0 * 0.1, 0.2);
  loop.RunUntil(2.0);
  EXPECT_FALSE(loop.controller().estimator().synced());
  EXPECT_LT(loop.Sample().dq_rad_s.norm(), 1e-3);
}

TEST(RobustLaw, ThetaHatIsProjectedFromTheStart) {
  const PlanarArm arm(PaperArm(1));
  const ControlConfig config = PaperController(PaperArm(1)).control;
  const RobustLaw law(config, arm, ParameterVector{{0.1, 5.0, 100.0}}, JointVector::Constant(2, 150.0),
                      0.001);
  EXPECT_TRUE(InProjectionSet(config.projection, arm, law.theta_hat()));
}

// With the torque clipped the reference gives way instead of winding up: no overshoot worth the name
// afterwards.
TEST(RobustLaw, DoesNotWindUpAgainstTheTorqueLimit) {
  ArmControllerConfig config = KnownArm(1);
  config.torque_limit_Nm = JointVector::Constant(2, 60.0);
  ClosedLoop loop(config, {PaperLeader(0.0), PlanarArm(config.arm).Theta()}, [](double) {
    Zeta rest = PaperLeader(0.0);
    rest.v_m_s.setZero();
    rest.a_m_s2.setZero();
    return rest;
  });
  loop.plant().q_rad = {-2.0, 1.0};
  loop.RunUntil(2.8);
  EXPECT_GT(loop.controller().saturated_ticks(), 5);
  loop.StartWindow();
  loop.RunUntil(4.0);
  EXPECT_LT(loop.max_m(), 1e-3);
}

}  // namespace
}  // namespace armada
