#include "firmware/app/initial_state.h"

#include <gtest/gtest.h>

#include <fstream>

#include "firmware/app/config/fleet_file.h"

namespace armada {
namespace {

ArmEntry PaperArm(size_t index) {
  std::vector<ConfigError> errors;
  const auto fleet = LoadFleet(ARMADA_SOURCE_DIR "/firmware/fleets/paper.toml", {}, &errors);
  EXPECT_TRUE(errors.empty());
  return fleet->arms[index];
}

// Tests run in parallel: a file each.
std::string TemporaryFile() {
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  return testing::TempDir() + "/armada_initial_state_" + test->name() + ".toml";
}

TEST(InitialState, ReadsBackExactlyWhatWasWritten) {
  const ArmEntry arm = PaperArm(5);
  ArmInitialState state = NominalInitialState(arm);
  state.zeta.x_m << 0.1, -4.999999999999999;
  state.zeta.v_m_s << 1.0 / 3.0, 2.0;
  state.zeta.a_m_s2 << -1e-17, 5.0;
  state.theta_hat *= 1.0 / 7.0;
  std::string error;
  ASSERT_TRUE(WriteInitialState(state, TemporaryFile(), &error)) << error;
  std::vector<ConfigError> errors;
  const auto read = LoadInitialState(TemporaryFile(), arm, &errors);
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->zeta.x_m, state.zeta.x_m);
  EXPECT_EQ(read->zeta.v_m_s, state.zeta.v_m_s);
  EXPECT_EQ(read->zeta.a_m_s2, state.zeta.a_m_s2);
  EXPECT_EQ(read->theta_hat, state.theta_hat);
}

TEST(InitialState, OfAnotherArmIsRefusedWithItsLine) {
  std::ofstream(TemporaryFile()) << "zeta_x_m = [1.0, 2.0]\ntheta_hat = [1.0, 2.0]\n";
  std::vector<ConfigError> errors;
  EXPECT_FALSE(LoadInitialState(TemporaryFile(), PaperArm(5), &errors).has_value());
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].line, 2);
  EXPECT_EQ(errors[0].message, "given 2 values, arm 6 has 6");
}

TEST(InitialState, MissingFileIsNamed) {
  std::vector<ConfigError> errors;
  EXPECT_FALSE(LoadInitialState("/nonexistent.toml", PaperArm(0), &errors).has_value());
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].file, "/nonexistent.toml");
}

}  // namespace
}  // namespace armada
