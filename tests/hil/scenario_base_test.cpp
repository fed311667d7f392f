// Scenarios that stand on others.

#include "hil/scenario_base.h"

#include <gtest/gtest.h>

#include "hil/scenario_file.h"
#include "tests/app/config_support.h"

namespace armada {
namespace {

const std::string kPaper = std::string(ARMADA_SOURCE_DIR) + "/hil/scenarios/paper.toml";

std::string On(const std::string& base, const std::string& rest) {
  return "name = \"test\"\nbase = \"" + base + "\"\n" + rest;
}

std::string ErrorsOf(const std::string& path, const std::vector<std::string>& sets = {}) {
  std::vector<ConfigError> errors;
  EXPECT_FALSE(LoadScenario(path, sets, &errors).has_value());
  return Text(errors);
}

TEST(ScenarioBase, GivesWhatTheFileDoesNotSay) {
  const TemporaryFile file(On(kPaper, "seconds = 20.0\n[disturbance]\namplitude_Nm = 5.0\n"));
  std::vector<ConfigError> errors;
  const auto scenario = LoadScenario(file.path(), {"leader.axis.1.amplitude_m=0.4"}, &errors);
  ASSERT_TRUE(scenario.has_value()) << Text(errors);
  EXPECT_EQ(scenario->name, "test");
  EXPECT_EQ(scenario->seconds, 20.0);
  EXPECT_EQ(scenario->window_start_s, 15.0);
  EXPECT_EQ(scenario->disturbance.amplitude_Nm, 5.0);
  EXPECT_EQ(scenario->disturbance.kind, DisturbanceKind::kUniform);
  EXPECT_EQ(scenario->leader.axes[0].amplitude_m, 0.4);
  EXPECT_EQ(scenario->leader.axes[0].offset_m, 1.2);
  EXPECT_EQ(scenario->fleet.arms.size(), 7u);  // of a fleet file that is named relative to the base
}

TEST(ScenarioBase, MayStandOnAnother) {
  const TemporaryFile first(On(kPaper,
                               "seconds = 20.0\n[overrides]\n\"arm.*.gravity_m_s2\" = 9.81\n"
                               "\"arm.*.base_y_m\" = 0.001\n"),
                            "first.toml");
  const TemporaryFile second(On("first.toml", "[overrides]\n\"arm.*.gravity_m_s2\" = 1.62\n"), "second.toml");
  std::vector<ConfigError> errors;
  const auto scenario = LoadScenario(second.path(), {}, &errors);
  ASSERT_TRUE(scenario.has_value()) << Text(errors);
  EXPECT_EQ(scenario->seconds, 20.0);
  EXPECT_EQ(scenario->fleet.arms[3].arm.gravity_m_s2, 1.62);
  EXPECT_EQ(scenario->fleet.arms[3].arm.base_y_m, 0.001);
}

TEST(ScenarioBase, AListReplacesAList) {
  const TemporaryFile first(On(kPaper,
                               "[[fault]]\nkind = \"bus_off\"\nat_s = 1.0\narm = 1\n"
                               "[[fault]]\nkind = \"bus_off\"\nat_s = 2.0\narm = 1\n"),
                            "first.toml");
  const TemporaryFile second(On("first.toml", "[[fault]]\nkind = \"bus_down\"\nat_s = 3.0\narm = 2\n"),
                             "second.toml");
  std::vector<ConfigError> errors;
  const auto scenario = LoadScenario(second.path(), {}, &errors);
  ASSERT_TRUE(scenario.has_value()) << Text(errors);
  ASSERT_EQ(scenario->faults.size(), 1u);
  EXPECT_EQ(scenario->faults[0].kind, FaultKind::kBusDown);
}

TEST(ScenarioBase, AMistakeHasTheLineOfTheFileItIsIn) {
  const TemporaryFile first(On(kPaper, "second = 20.0\n"), "first.toml");
  const TemporaryFile second(On("first.toml", "\n\nwindow_start = 3.0\n"), "second.toml");
  const std::string errors = ErrorsOf(second.path());
  EXPECT_NE(errors.find(first.path() + ":3: second: unknown key"), std::string::npos) << errors;
  EXPECT_NE(errors.find(second.path() + ":5: window_start: unknown key"), std::string::npos) << errors;
}

TEST(ScenarioBase, ThatIsNotThereIsNamedWithItsLine) {
  const TemporaryFile file(On("nowhere.toml", ""));
  EXPECT_NE(
      ErrorsOf(file.path()).find(file.path() + ":2: base: given \"nowhere.toml\", but there is no file"),
      std::string::npos);
}

TEST(ScenarioBase, ThatIsItselfIsRefused) {
  const TemporaryFile file(On("config.toml", ""));
  EXPECT_NE(ErrorsOf(file.path()).find(":2: base: more than 8 bases"), std::string::npos);
}

TEST(ScenarioBase, IsNotForTheCommandLine) {
  const TemporaryFile file(On(kPaper, ""));
  EXPECT_NE(ErrorsOf(file.path(), {"base=" + kPaper}).find("--set: base: allowed in a scenario file"),
            std::string::npos);
}

}  // namespace
}  // namespace armada
