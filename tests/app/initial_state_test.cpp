#include "firmware/app/initial_state.h"

#include <gtest/gtest.h>

#include <fstream>

#include "firmware/app/config/fleet_file.h"

namespace armada {
namespace {

ArmEntry PaperEntry(size_t index) {
  std::vector<ConfigError> errors;
  const auto fleet = LoadFleet(ARMADA_SOURCE_DIR "/firmware/fleets/paper.toml", {}, &errors);
  EXPECT_TRUE(errors.empty());
  return fleet->arms[index];
}

// Tests run in parallel: a file each.
std::string FreshPath() {
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  return testing::TempDir() + "/armada_initial_state_" + test->name() + ".toml";
}

TEST(InitialState, ReadsBackExactlyWhatWasWritten) {
  const ArmEntry arm = PaperEntry(5);
  ArmInitialState state = NominalInitialState(arm);
  state.zeta.x_m << 0.1, -4.999999999999999;
  state.zeta.v_m_s << 1.0 / 3.0, 2.0;
  state.zeta.a_m_s2 << -1e-17, 5.0;
  state.theta_hat *= 1.0 / 7.0;
  std::string error;
  ASSERT_TRUE(WriteInitialState(state, arm, FreshPath(), &error)) << error;
  std::vector<ConfigError> errors;
  const auto read = LoadInitialState(FreshPath(), arm, &errors);
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->zeta.x_m, state.zeta.x_m);
  EXPECT_EQ(read->zeta.v_m_s, state.zeta.v_m_s);
  EXPECT_EQ(read->zeta.a_m_s2, state.zeta.a_m_s2);
  EXPECT_EQ(read->theta_hat, state.theta_hat);
  EXPECT_EQ(read->P_theta.size(), 0);
}

// What arm 6 of the paper learns in 5 s at rest under gravity-free torques of nobody: its controller alone.
ArmInitialState Learnt(const ArmEntry& arm) {
  ArmControllerConfig config;
  config.arm = arm.arm;
  config.control = arm.control;
  config.torque_limit_Nm = JointVector::Constant(arm.arm.dof, 300.0);
  ArmInitialState initial = NominalInitialState(arm);
  initial.theta_hat *= 2.0;
  ArmController controller(config, initial, StartMode::kRunning);
  JointVector q_rad = JointVector::LinSpaced(arm.arm.dof, 0.3, 0.9);
  JointVector dq_rad_s = JointVector::Zero(arm.arm.dof);
  for (int k = 0; k < 50; ++k) {
    const double t_s = k * config.timing.period_s;
    q_rad += config.timing.period_s * dq_rad_s;
    dq_rad_s.setConstant(std::sin(5.0 * t_s));
    ArmInput in;
    in.tick_s = in.sample_s = t_s;
    in.q_rad = q_rad;
    in.dq_rad_s = dq_rad_s;
    controller.Step(in);
  }
  return WarmStart(arm, controller);
}

TEST(InitialState, WhatWasLearntReadsBackExactly) {
  const ArmEntry arm = PaperEntry(5);
  const ArmInitialState learnt = Learnt(arm);
  EXPECT_NE(learnt.theta_hat, 2.0 * NominalInitialState(arm).theta_hat);
  const double deviation = arm.control.adaptation.initial_deviation;
  EXPECT_LT(learnt.P_theta.trace(), 6.0 * deviation * deviation) << "surer than at its start";
  std::string error;
  ASSERT_TRUE(WriteInitialState(learnt, arm, FreshPath(), &error)) << error;
  std::vector<ConfigError> errors;
  const auto read = LoadInitialState(FreshPath(), arm, &errors);
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->theta_hat, learnt.theta_hat);
  EXPECT_EQ(read->P_theta, learnt.P_theta);
}

TEST(InitialState, IsBoundToTheArmsEntryButNotToItsTuning) {
  const ArmEntry arm = PaperEntry(5);
  std::string error;
  ASSERT_TRUE(WriteInitialState(Learnt(arm), arm, FreshPath(), &error)) << error;
  const auto fits = [](const ArmEntry& entry) {
    std::vector<ConfigError> errors;
    const bool read = LoadInitialState(FreshPath(), entry, &errors).has_value();
    EXPECT_EQ(read, errors.empty());
    if (!read) {
      EXPECT_EQ(errors[0].key, "arm_entry");
    }
    return read;
  };
  ArmEntry tuned = arm;
  tuned.control.gains.K_s_Nms_rad *= 2.0;
  tuned.control.adaptation.drift_variance *= 2.0;
  tuned.bus = "socketcan:can9";
  EXPECT_TRUE(fits(tuned));
  ArmEntry other = arm;
  other.arm.links[1].m_kg *= 1.001;
  EXPECT_FALSE(fits(other));
  other = arm;
  other.id = 7;
  EXPECT_FALSE(fits(other));
  other = arm;
  other.joints[0].gear_ratio *= 2.0;
  EXPECT_FALSE(fits(other));
}

TEST(InitialState, ACovarianceThatIsNoneIsRefusedWithItsLine) {
  for (const char* P : {"[[1.0, 0.0], [0.0, 1.0]]", "[[1.0, 0.0, 0.0], [0.0, 1.0], [0.0, 0.0, 1.0]]",
                        "[[1.0, 2.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]",
                        "[[1.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 1.0]]"}) {
    std::ofstream(FreshPath()) << "theta_hat = [1.0, 2.0, 3.0]\nP_theta = " << P << "\n";
    std::vector<ConfigError> errors;
    EXPECT_FALSE(LoadInitialState(FreshPath(), PaperEntry(0), &errors).has_value()) << P;
    ASSERT_EQ(errors.size(), 1u) << P;
    EXPECT_EQ(errors[0].line, 2) << P;
  }
}

TEST(InitialState, OfAnotherArmIsRefusedWithItsLine) {
  std::ofstream(FreshPath()) << "zeta_x_m = [1.0, 2.0]\ntheta_hat = [1.0, 2.0]\n";
  std::vector<ConfigError> errors;
  EXPECT_FALSE(LoadInitialState(FreshPath(), PaperEntry(5), &errors).has_value());
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].line, 2);
  EXPECT_EQ(errors[0].message, "given 2 values, arm 6 has 6");
}

TEST(InitialState, MissingFileIsNamed) {
  std::vector<ConfigError> errors;
  EXPECT_FALSE(LoadInitialState("/nonexistent.toml", PaperEntry(0), &errors).has_value());
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].file, "/nonexistent.toml");
}

}  // namespace
}  // namespace armada
