// Scenario files: the ones that come with Armada, every rule, overrides, and the effective files of a run.

#include "hil/scenario_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "firmware/app/config/fleet_file.h"
#include "tests/app/config_support.h"

namespace armada {
namespace {

const std::string kSource = ARMADA_SOURCE_DIR;

ScenarioConfig Load(const std::string& name, const std::vector<std::string>& sets = {}) {
  std::vector<ConfigError> errors;
  auto scenario = LoadScenario(kSource + "/hil/scenarios/" + name + ".toml", sets, &errors);
  EXPECT_TRUE(scenario.has_value()) << Text(errors);
  return scenario.value_or(ScenarioConfig{});
}

void ExpectSameValues(const std::vector<EffectiveValue>& actual,
                      const std::vector<EffectiveValue>& expected) {
  ASSERT_EQ(actual.size(), expected.size());
  for (size_t i = 0; i < expected.size(); ++i) {
    if (expected[i].key == "fleet") continue;
    EXPECT_EQ(actual[i].key, expected[i].key);
    EXPECT_EQ(actual[i].value, expected[i].value) << expected[i].key;
  }
}

class ShippedScenario : public testing::TestWithParam<std::string> {};

TEST_P(ShippedScenario, IsValidAndNamedAsItsFile) {
  const ScenarioConfig scenario = Load(GetParam());
  EXPECT_EQ(scenario.name, std::filesystem::path(GetParam()).filename());
  EXPECT_EQ(scenario.fleet.file, kSource + "/firmware/fleets/" + scenario.fleet.name + ".toml");
}

TEST_P(ShippedScenario, ReadsBackFromItsEffectiveFiles) {
  const ScenarioConfig scenario =
      Load(GetParam(), {"seconds=20.1", "arm.2.base_y_m=0.001", "drive.velocity_noise_rad_s=0.05"});
  const std::string directory = TestDirectory();
  std::string error;
  ASSERT_TRUE(WriteEffective(scenario, directory, &error)) << error;
  std::vector<ConfigError> errors;
  const auto again = LoadScenario(directory + "/scenario.toml", {}, &errors);
  ASSERT_TRUE(again.has_value()) << Text(errors);
  EXPECT_EQ(again->fleet.file, directory + "/fleet.toml");
  ExpectSameValues(EffectiveValues(*again), EffectiveValues(scenario));
  ExpectSameValues(EffectiveValues(again->fleet), EffectiveValues(scenario.fleet));
  std::filesystem::remove_all(directory);
}

std::vector<std::string> ShippedScenarios() {
  std::vector<std::string> names;
  const std::filesystem::path folder = kSource + "/hil/scenarios";
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    names.push_back(entry.path().lexically_relative(folder).replace_extension().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

INSTANTIATE_TEST_SUITE_P(All, ShippedScenario, testing::ValuesIn(ShippedScenarios()),
                         [](const testing::TestParamInfo<std::string>& tested) {
                           std::string name = tested.param;
                           std::replace(name.begin(), name.end(), '/', '_');
                           return name;
                         });

TEST(Scenario, OfThePaperIsItsSection4) {
  const ScenarioConfig scenario = Load("paper");
  EXPECT_EQ(scenario.start.kind, StartKind::kBox);
  EXPECT_EQ(scenario.disturbance.amplitude_Nm, 40.0);
  ASSERT_EQ(scenario.leader.axes.size(), 2u);
  EXPECT_EQ(scenario.leader.axes[0].offset_m, 1.2);
  EXPECT_EQ(scenario.leader.axes[1].amplitude_m, 0.3);
  EXPECT_EQ(scenario.seconds, 30.0);
  EXPECT_EQ(scenario.window_start_s, 15.0);
}

TEST(Scenario, SwitchingTopologiesShareNoPinAndNoEdge) {
  const FleetConfig fleet = Load("switching").fleet;
  ASSERT_EQ(fleet.topologies.size(), 4u);
  for (size_t a = 0; a < 4; ++a) {
    const Digraph of_a = fleet.Graph(a);
    EXPECT_TRUE(of_a.LeaderReachesAll());
    for (size_t b = 0; b < a; ++b) {
      const Digraph of_b = fleet.Graph(b);
      for (int i = 0; i < 7; ++i) {
        EXPECT_EQ(of_a.pin(i) * of_b.pin(i), 0.0);
        for (int j = 0; j < 7; ++j) EXPECT_EQ(of_a.weight(i, j) * of_b.weight(i, j), 0.0);
      }
    }
  }
}

TEST(Scenario, OverridesReachTheFleet) {
  const ScenarioConfig gravity = Load("gravity");
  for (const ArmEntry& arm : gravity.fleet.arms) EXPECT_EQ(arm.arm.gravity_m_s2, 9.81);
  EXPECT_TRUE(Load("leaderless").fleet.estimator.leaderless);
}

TEST(Scenario, TheCommandLineGoesBeforeTheFilesOverrides) {
  const ScenarioConfig scenario =
      Load("gravity", {"arm.3.gravity_m_s2=1.62", "leader.axis.1.amplitude_m=0.4"});
  EXPECT_EQ(scenario.fleet.arms[1].arm.gravity_m_s2, 9.81);
  EXPECT_EQ(scenario.fleet.arms[2].arm.gravity_m_s2, 1.62);
  EXPECT_EQ(scenario.leader.axes[0].amplitude_m, 0.4);
}

constexpr const char* kScenario = R"(name = "test"
fleet = "FLEET"
seconds = 30.0
window_start_s = 15.0
[leader]
axis = [{ offset_m = 1.2, amplitude_m = 0.5, frequency_hz = 0.5 },
        { offset_m = 1.3, amplitude_m = 0.3, frequency_hz = 0.5, phase_rad = 1.5707963267948966 }]
[start]
kind = "box"
[criterion]
kind = "tracking"
[overrides]
"timing.period_s" = 0.01
"arm.*.base_x_m" = 0
"arm.2.base_x_m" = 0.01
)";

std::string ScenarioText() {
  std::string text = kScenario;
  return text.replace(text.find("FLEET"), 5, kSource + "/firmware/fleets/paper.toml");
}

TEST(Scenario, AnExceptionGoesBeforeAStar) {
  std::string text = WithLine(ScenarioText(), 14, "\"arm.2.base_x_m\" = 0.01");
  text = WithLine(text, 15, "\"arm.*.base_x_m\" = 0");
  const TemporaryFile file(text);
  std::vector<ConfigError> errors;
  const auto scenario = LoadScenario(file.path(), {}, &errors);
  ASSERT_TRUE(scenario.has_value()) << Text(errors);
  EXPECT_EQ(scenario->fleet.arms[1].arm.base_x_m, 0.01);
}

class ScenarioRule : public testing::TestWithParam<ConfigCase> {};

TEST_P(ScenarioRule, IsReportedWithItsLineAndWhatIsAllowed) {
  const ConfigCase& one = GetParam();
  const TemporaryFile file(WithLine(ScenarioText(), one.line, one.replacement));
  std::vector<ConfigError> errors;
  EXPECT_FALSE(LoadScenario(file.path(), {}, &errors).has_value());
  ExpectOneError(one, file.path(), errors);
}

INSTANTIATE_TEST_SUITE_P(
    All, ScenarioRule,
    testing::Values(
        ConfigCase{"MissingFleet", 2, "", "fleet", {"missing"}, 1},
        ConfigCase{
            "FleetThatIsNotThere", 2, "fleet = \"nowhere.toml\"", "fleet", {"\"nowhere.toml\"", "no file"}},
        ConfigCase{"UnknownKey", 3, "second = 30.0", "second", {"\"seconds\""}},
        ConfigCase{"UnknownOverride", 13, "\"timming.period_s\" = 0.01", "timming.period_s", {"\"timing\""}},
        ConfigCase{"UnknownOverrideBelowATable",
                   13,
                   "\"timing.perod_s\" = 0.01",
                   "timing.perod_s",
                   {"\"period_s\""}},
        ConfigCase{"OverrideOfWrongType",
                   13,
                   "\"timing.period_s\" = true",
                   "timing.period_s",
                   {"given true", "a number"}},
        ConfigCase{
            "OverrideOutOfRange", 13, "\"plant.step_s\" = 0.002", "plant.step_s", {"0.002", "0.001 s"}},
        ConfigCase{
            "OverrideOfAnUnknownArm", 13, "\"arm.9.base_x_m\" = 1", "arm.9.base_x_m", {"\"9\"", "1, 2, 3"}},
        ConfigCase{"OverrideWithoutQuotes", 13, "timing.perod_s = 1", "timing.perod_s", {"\"period_s\""}},
        ConfigCase{"WindowBeyondTheEnd",
                   4,
                   "window_start_s = 30",
                   "window_start_s",
                   {"given 30 s", "below seconds = 30 s"}},
        ConfigCase{"UnknownLeader",
                   5,
                   "[leader]\nkind = \"circle\"",
                   "leader.kind",
                   {"\"circle\"", "\"waypoints\""},
                   6},
        ConfigCase{"LeaderOfAnotherDimension", 6, "axis = [", "leader.axis", {"given 1", "2"}},
        ConfigCase{
            "NoWaypoints", 5, "[leader]\nkind = \"waypoints\"", "leader.waypoints_m", {"no waypoint"}, 5},
        ConfigCase{"WaypointInSpace",
                   5,
                   "[leader]\nkind = \"waypoints\"\nwaypoints_m = [[1, 1], [1, 1.2, 1]]",
                   "leader.waypoints_m.2",
                   {"given 3 numbers", "2"},
                   7},
        ConfigCase{"NoLeader",
                   5,
                   "[leader]\nkind = \"none\"",
                   "leader.kind",
                   {"given \"none\"", "leaderless = false"},
                   6},
        ConfigCase{"AgreementWithALeader",
                   11,
                   "kind = \"agreement\"",
                   "criterion.kind",
                   {"\"agreement\"", "\"tracking\""}},
        ConfigCase{"SpeedBeyondA2",
                   13,
                   "\"estimator.beta_1_m_s\" = 1.88",
                   "estimator.beta_1_m_s",
                   {"given 1.88 m/s", "1.2 times the leader's 1.571 m/s", "1.885"}},
        ConfigCase{"AccelerationBeyondA2",
                   13,
                   "\"estimator.beta_2_m_s2\" = 5.9",
                   "estimator.beta_2_m_s2",
                   {"given 5.9 m/s^2", "1.2 times the leader's 4.935 m/s^2"}},
        ConfigCase{"JerkBeyondA2",
                   13,
                   "\"estimator.beta_3_m_s3\" = 18.6",
                   "estimator.beta_3_m_s3",
                   {"given 18.6 m/s^3", "1.2 times the leader's 15.503 m/s^3"}},
        ConfigCase{"LeaderBeyondReach",
                   15,
                   "\"arm.5.base_x_m\" = -0.02",
                   "leader",
                   {"arm 5", "t = 0.348 s", "2.199 m from its base", "0.21 to 2.195 m"},
                   5},
        ConfigCase{"LeaderWithinTheInnerEdge",
                   15,
                   "\"arm.1.base_x_m\" = 1.2\n\"arm.1.base_y_m\" = 1",
                   "leader",
                   {"arm 1", "0.51 to 2.295 m"},
                   5},
        ConfigCase{"WatchdogWithinThePeriod",
                   8,
                   "[drive]\nwatchdog_s = 0.01\n[start]",
                   "drive.watchdog_s",
                   {"given 0.01 s", "above timing.period_s = 0.01 s"},
                   9},
        ConfigCase{"PlantStepBeyondThePeriod",
                   13,
                   "timing = { period_s = 5e-4, sample_to_torque_s = 0, feedback_timeout_s = 4e-4 }",
                   "plant.step_s",
                   {"given 0.001 s", "at most timing.period_s = 5e-04 s"},
                   1},
        ConfigCase{"LostLinkThatIsNone",
                   8,
                   "[[network.lost]]\nfrom = 5\nto = 2\nat_s = 1.0\n[start]",
                   "network.lost.1",
                   {"arm 2 does not hear arm 5"},
                   8},
        ConfigCase{"LostLinkThatComesBackTooSoon",
                   8,
                   "[[network.lost]]\nfrom = 0\nto = 3\nat_s = 1.0\nuntil_s = 1.0\n[start]",
                   "network.lost.1.until_s",
                   {"given 1 s", "above at_s = 1 s"},
                   12},
        ConfigCase{"LostLinkWithoutATime",
                   8,
                   "[[network.lost]]\nfrom = 0\nto = 3\n[start]",
                   "network.lost.1.at_s",
                   {"missing"},
                   8},
        ConfigCase{"StandingArmThatIsNone",
                   11,
                   "standing = [2, 9]",
                   "criterion.standing.2",
                   {"given 9", "1, 2, 3, 4, 5, 6, 7"}},
        ConfigCase{
            "StandingArmsThatAreNoList", 11, "standing = 2", "criterion.standing", {"list of whole numbers"}},
        ConfigCase{"CentreInSpace",
                   9,
                   "zeta_x_centre_m = [1, 1, 1]",
                   "start.zeta_x_centre_m",
                   {"given 3 values", "2"}}),
    [](const testing::TestParamInfo<ConfigCase>& tested) { return tested.param.name; });

std::string ErrorsOfLeaderless(const std::vector<std::string>& sets) {
  std::vector<ConfigError> errors;
  EXPECT_FALSE(LoadScenario(kSource + "/hil/scenarios/leaderless.toml", sets, &errors).has_value());
  return Text(errors);
}

TEST(Scenario, OfALeaderlessFleetHasNoLeaderAndAgrees) {
  EXPECT_NE(ErrorsOfLeaderless({"leader.kind=waypoints", "leader.waypoints_m=[[1,1]]"})
                .find("leader.kind: given \"waypoints\""),
            std::string::npos);
  EXPECT_NE(ErrorsOfLeaderless({"criterion.kind=tracking"}).find("is \"agreement\""), std::string::npos);
  EXPECT_NE(ErrorsOfLeaderless({"start.kind=near_leader"}).find("start.kind: given \"near_leader\""),
            std::string::npos);
}

TEST(Scenario, OfALeaderlessFleetAgreesWithinReach) {
  EXPECT_NE(ErrorsOfLeaderless({"start.zeta_range=0.7"}).find("arm 5 may not reach the agreed point"),
            std::string::npos);
  EXPECT_NE(ErrorsOfLeaderless({"start.zeta_x_centre_m=0.6"}).find("arm 1 may not reach the agreed point"),
            std::string::npos);
}

TEST(Scenario, MistakesOfScenarioAndFleetAreReportedTogether) {
  std::vector<ConfigError> errors;
  EXPECT_FALSE(LoadScenario(kSource + "/hil/scenarios/paper.toml",
                            {"seconds=0", "arm.1.bus=can0", "nothing=1", "control.law=none", "nonsense"},
                            &errors));
  EXPECT_EQ(errors.size(), 5u) << Text(errors);
}

TEST(Scenario, AMistakeInTheFleetFileHasTheFleetFilesLine) {
  const TemporaryFile fleet("name = \"x\"\nnme = 3\n", "fleet.toml");
  std::string text = kScenario;
  const TemporaryFile file(text.replace(text.find("FLEET"), 5, "fleet.toml"));
  std::vector<ConfigError> errors;
  EXPECT_FALSE(LoadScenario(file.path(), {"arm=[]"}, &errors).has_value());
  EXPECT_NE(Text(errors).find(fleet.path() + ":2: nme: unknown key; did you mean \"name\"?"),
            std::string::npos)
      << Text(errors);
}

TEST(Scenario, AnEffectiveFileThatCannotBeWrittenIsNamed) {
  std::string error;
  EXPECT_FALSE(WriteEffective(Load("paper"), "/no/such/directory", &error));
  EXPECT_EQ(error, "cannot write /no/such/directory/fleet.toml: No such file or directory");
}

TEST(ParameterReference, IsTheOneInTheDocs) {
  std::ostringstream wanted;
  WriteParameterReference(wanted);
  std::ifstream stream(kSource + "/docs/parameters.md");
  std::stringstream committed;
  committed << stream.rdbuf();
  EXPECT_EQ(committed.str(), wanted.str())
      << "docs/parameters.md is out of date: armada params > docs/parameters.md";
}

}  // namespace
}  // namespace armada
