// Files as a whole: what cannot be read, overrides, the effective file, and the fleet that comes with Armada.

#include <gtest/gtest.h>

#include <sstream>

#include "firmware/app/config/fleet_file.h"
#include "firmware/app/config/spelling.h"
#include "firmware/app/config/toml_parser.h"
#include "firmware/app/config/value_text.h"
#include "tests/app/config_support.h"

namespace armada {
namespace {

const std::string kPaperFleet = ARMADA_SOURCE_DIR "/firmware/fleets/paper.toml";

FleetConfig Paper(const std::vector<std::string>& sets = {}) {
  std::vector<ConfigError> errors;
  const auto fleet = LoadFleet(kPaperFleet, sets, &errors);
  EXPECT_TRUE(fleet.has_value()) << Text(errors);
  return fleet.value_or(FleetConfig{});
}

std::vector<ConfigError> ErrorsWith(const std::vector<std::string>& sets) {
  std::vector<ConfigError> errors;
  EXPECT_FALSE(LoadFleet(kPaperFleet, sets, &errors).has_value());
  return errors;
}

TEST(FleetFile, ThePapersFleetIsTheOneOfItsTable) {
  const FleetConfig fleet = Paper();
  EXPECT_EQ(fleet.name, "paper");
  EXPECT_EQ(fleet.file, kPaperFleet);
  ASSERT_EQ(fleet.arms.size(), 7u);
  const double reach_m[] = {2.3, 2.3, 2.4, 2.3, 2.2, 3.3, 3.3};
  const double mass_kg[] = {1.4, 1.8, 1.3, 2.3, 3.1, 3.4, 4.4};
  for (size_t i = 0; i < 7; ++i) {
    const ArmEntry& arm = fleet.arms[i];
    const int dof = i < 5 ? 2 : 3;
    EXPECT_EQ(arm.id, static_cast<int>(i) + 1);
    EXPECT_EQ(arm.arm.dof, dof);
    EXPECT_NEAR(PlanarArm(arm.arm).reach_max_m(), reach_m[i], 1e-12);
    double mass = 0.0;
    for (int k = 0; k < dof; ++k) mass += arm.arm.links[static_cast<size_t>(k)].m_kg;
    EXPECT_NEAR(mass, mass_kg[i], 1e-12);
    ASSERT_EQ(arm.joints.size(), static_cast<size_t>(dof));
    EXPECT_EQ(arm.joints.back().node_id, dof);
    EXPECT_EQ(arm.joints.back().torque_limit_Nm, dof == 2 ? 150.0 : 300.0);
    EXPECT_EQ(arm.control.gains.K_s_Nms_rad,
              JointVector(JointVector::Constant(dof, dof == 2 ? 100.0 : 150.0)));
    EXPECT_EQ(arm.control.gains.K_r_Nm, JointVector(JointVector::Constant(dof, 60.0)));
    EXPECT_EQ(arm.control.gains.K_x_Ns_m, TaskVector(TaskVector::Constant(2, 50.0)));
  }
  EXPECT_EQ(fleet.arms[5].control.subtask.kind, SubtaskKind::kPosture);
  EXPECT_EQ(fleet.arms[5].control.subtask.gain, 9.0);
  EXPECT_EQ(fleet.arms[6].control.subtask.kind, SubtaskKind::kManipulability);
}

TEST(FleetFile, ThePapersGraphHasItsLaplacian) {
  const Digraph graph = Paper().Graph(0);
  const double diagonal[] = {0, 2, 0, 2, 0, 1, 0};
  const double pins[] = {1, 0, 1, 0, 1, 0, 1};
  for (int i = 0; i < 7; ++i) {
    EXPECT_EQ(graph.Laplacian(i, i), diagonal[i]);
    EXPECT_EQ(graph.pin(i), pins[i]);
  }
  for (const auto& [i, j] : {std::pair{1, 0}, {1, 2}, {3, 0}, {3, 2}, {5, 4}})
    EXPECT_EQ(graph.Laplacian(i, j), -1.0);
}

TEST(FleetFile, WhatCannotBeReadIsNamed) {
  std::vector<ConfigError> errors;
  EXPECT_FALSE(LoadFleet("no/such.toml", {}, &errors).has_value());
  EXPECT_FALSE(LoadFleet(testing::TempDir(), {}, &errors).has_value());
  EXPECT_EQ(Text(errors), "no/such.toml: cannot be read: No such file or directory\n" + testing::TempDir() +
                              ": cannot be read: Is a directory\n");
}

TEST(FleetFile, OneMebibyteIsReadAndNoMore) {
  const std::string comment(kMaxConfigBytes - 1, '#');
  const TemporaryFile largest(comment + "\n");
  std::vector<ConfigError> errors;
  EXPECT_TRUE(LoadToml(largest.path(), &errors).has_value()) << Text(errors);
  const TemporaryFile larger(comment + "#\n", "larger.toml");
  EXPECT_FALSE(LoadToml(larger.path(), &errors).has_value());
  EXPECT_NE(Text(errors).find("allowed is at most 1 MiB"), std::string::npos);
}

TEST(FleetFile, GarbageIsAnErrorAndNothingElse) {
  const std::string deep(5000, '[');
  for (const std::string& text :
       {std::string("\xff\xfe\x00\x01", 4), std::string(100, '\0'), "a = " + deep, "[" + deep,
        std::string("a = \"\\uD800\""), std::string("a = 99999999999999999999")}) {
    std::vector<ConfigError> errors;
    EXPECT_FALSE(ParseToml(text, "garbage", &errors).has_value());
    EXPECT_EQ(errors.size(), 1u);
  }
}

TEST(FleetFile, WhatIsNoTomlIsToldWithItsLine) {
  for (const char* text : {"[a]\n\nb = [1]\nä = 1\n", "a = 1\nb = 2\nc = 3\n[[[x]]]\nd = 4\n",
                           "\n\n\na = かな", "# ä\nb = \"ä\" # ä\n\n[[\n"}) {
    std::vector<ConfigError> errors;
    EXPECT_FALSE(ParseToml(text, "a.toml", &errors).has_value());
    ASSERT_EQ(errors.size(), 1u);
    EXPECT_EQ(errors[0].line, 4) << ToString(errors[0]);
  }
}

TEST(FleetFile, ErrorsAreWrittenAsFileLineKeyMessage) {
  EXPECT_EQ(ToString({"a.toml", 3, "arm.1.id", "missing"}), "a.toml:3: arm.1.id: missing");
  EXPECT_EQ(ToString({"--set", 0, "x", "unknown"}), "--set: x: unknown");
  EXPECT_EQ(ToString({"a.toml", 3, "", "broken"}), "a.toml:3: broken");
}

TEST(FleetFile, TheEffectiveFileReadsBackToTheSameValues) {
  for (const std::vector<std::string>& sets :
       {std::vector<std::string>{},
        {"arm.*.gravity_m_s2=9.81", "estimator.beta_1_m_s=4.000000000000001", "arm.3.base_x_m=-0.1",
         "name=\"a \\\"b\\\"\""},
        {"arm.6.q_min_rad=-3", "arm.7.q_max_rad=[1.5, 2.5, 3]",
         "arm.6.obstacle=[{x_m=3.0, y_m=-1.0}, {kind=\"half_plane\", y_m=-0.5, normal_rad=1.57}]"},
        {"estimator.leaderless=true", "topology_period_s=0.5",
         "graph=[{edges=[{from=1,to=2,weight=0.3},{from=2,to=3},{from=3,to=4},{from=4,to=5},{from=5,to=6},{"
         "from=6,to=7}]},"
         "{edges=[{from=7,to=6},{from=6,to=5},{from=5,to=4},{from=4,to=3},{from=3,to=2},{from=2,to=1}]}]"}}) {
    const FleetConfig fleet = Paper(sets);
    std::ostringstream written;
    WriteFleet(fleet, written);
    const TemporaryFile file(written.str());
    std::vector<ConfigError> errors;
    const auto again = LoadFleet(file.path(), {}, &errors);
    ASSERT_TRUE(again.has_value()) << Text(errors);
    const auto expected = EffectiveValues(fleet);
    const auto actual = EffectiveValues(*again);
    ASSERT_EQ(actual.size(), expected.size());
    for (size_t i = 0; i < expected.size(); ++i) {
      EXPECT_EQ(actual[i].key, expected[i].key);
      EXPECT_EQ(actual[i].value, expected[i].value) << expected[i].key;
    }
  }
}

TEST(FleetFile, LimitsAndObstaclesComeWithTheArm) {
  const FleetConfig fleet = Paper(
      {"arm.6.q_min_rad=-3", "arm.6.obstacle=[{x_m=3.0}, {kind=\"half_plane\", y_m=-0.5, normal_rad=1.57}]"});
  const PlanarArmConfig& arm = fleet.arms[5].arm;
  EXPECT_EQ(arm.q_min_rad, JointVector::Constant(3, -3.0)) << "one value stands for all joints";
  EXPECT_EQ(arm.q_max_rad.size(), 0) << "no limit";
  ASSERT_EQ(arm.obstacle_count, 2);
  EXPECT_EQ(arm.obstacles[0].kind, ObstacleKind::kDisc);
  EXPECT_EQ(arm.obstacles[1].y_m, -0.5);
  EXPECT_EQ(fleet.arms[6].arm.obstacle_count, 0);
}

TEST(FleetFile, TheLawAsPrintedHasItsPostureAsPrinted) {
  EXPECT_EQ(Paper().arms[5].control.subtask.form, PostureForm::kExact);
  EXPECT_EQ(Paper({"control.law=paper"}).arms[5].control.subtask.form, PostureForm::kPrinted);
}

TEST(Override, ReplacesAValueOfTheFleet) {
  EXPECT_EQ(Paper({"timing.period_s=0.02"}).timing.period_s, 0.02);
  EXPECT_EQ(Paper({"control.law=paper"}).arms[4].control.law, LawKind::kPaper);
  EXPECT_EQ(Paper({"name=\"other\""}).name, "other");
  EXPECT_EQ(Paper({"graph.1.edges.5.weight=0.25"}).topologies[0].edges[4].weight, 0.25);
  EXPECT_EQ(Paper({"arm.2.control.gains.K_s_Nms_rad=[80, 90]"}).arms[1].control.gains.K_s_Nms_rad[1], 90.0);
}

TEST(Override, TakesABareWordForText) {
  EXPECT_EQ(Paper({"arm.2.bus=socketcan:can0"}).arms[1].bus, "socketcan:can0");
  EXPECT_EQ(Paper({"arm.2.bus=udp:239.74.163.99:43113?ttl=1"}).arms[1].bus, "udp:239.74.163.99:43113?ttl=1");
}

TEST(Override, GoesToOneArmById) {
  const FleetConfig fleet = Paper({"arm.6.control.subtask.kind=none"});
  EXPECT_EQ(fleet.arms[5].control.subtask.kind, SubtaskKind::kNone);
  EXPECT_EQ(fleet.arms[6].control.subtask.kind, SubtaskKind::kManipulability);
}

TEST(Override, GoesToAllArmsByAStar) {
  const FleetConfig fleet = Paper({"arm.*.gravity_m_s2=9.81", "arm.*.link.2.m_kg=0.7"});
  for (const ArmEntry& arm : fleet.arms) {
    EXPECT_EQ(arm.arm.gravity_m_s2, 9.81);
    EXPECT_EQ(arm.arm.links[1].m_kg, 0.7);
  }
}

TEST(Override, ALaterOneGoesBeforeAnEarlierOne) {
  const FleetConfig fleet =
      Paper({"arm.*.base_x_m=1", "arm.3.base_x_m=2", "timing.period_s=0.03", "timing.period_s=0.02"});
  EXPECT_EQ(fleet.arms[1].arm.base_x_m, 1.0);
  EXPECT_EQ(fleet.arms[2].arm.base_x_m, 2.0);
  EXPECT_EQ(fleet.timing.period_s, 0.02);
}

TEST(Override, MistakesAreErrorsOfTheCommandLine) {
  for (const auto& [set, message] : std::vector<std::pair<std::string, std::string>>{
           {"period", "--set: given \"period\", expected key=value\n"},
           {"=3", "--set: given \"=3\", expected key=value\n"},
           {"name=a b",
            "--set: name: given \"a b\", expected a TOML value (a number, true, false, \"text\", a list) or "
            "a word\n"},
           {"name=",
            "--set: name: given \"\", expected a TOML value (a number, true, false, \"text\", a list) or a "
            "word\n"},
           {"name=\"a\"\nx = 1",
            "--set: name: given \"\\\"a\\\"\\u000ax = 1\", expected a TOML value (a number, true, false, "
            "\"text\", a list) or a word\n"},
           {"timing..period_s=1", "--set: timing..period_s: has an empty part\n"},
           {"timing.period=1", "--set: timing.period: unknown key; did you mean \"period_s\"?\n"},
           {"timming.period_s=1", "--set: timming: unknown key; did you mean \"timing\"?\n"},
           {"timing.period_s=fast", "--set: timing.period_s: given \"fast\", expected a number\n"},
           {"timing.period_s.x=1", "--set: timing.period_s.x: is below a single value, 0.01\n"},
           {"arm.9.base_x_m=1",
            "--set: arm.9.base_x_m: no element \"9\", allowed are * or one of: 1, 2, 3, 4, 5, 6, 7\n"},
           {"arm.6.link.2.r_m=1.2",
            "--set: arm.6.link.2.r_m: given 1.2 m, allowed is above 0 up to the link's l_m = 1.1 m\n"}}) {
    EXPECT_EQ(Text(ErrorsWith({set})), message);
  }
}

TEST(Override, ManyMistakesAreReportedTogether) {
  EXPECT_EQ(ErrorsWith({"x", "timing.period_s=0", "arm.*.torque_limit_Nm=-1"}).size(), 9u);
}

TEST(Spelling, FindsWhatWasMeant) {
  const std::vector<std::string> names = {"period_s", "torque_limit_Nm", "id"};
  EXPECT_EQ(NearestName("torque_limit_nm", names), "torque_limit_Nm");
  EXPECT_EQ(NearestName("period", names), "period_s");
  EXPECT_EQ(NearestName("colour", names), std::nullopt);
  EXPECT_EQ(NearestName(std::string(100000, 'x'), names), std::nullopt);
}

TEST(ValueText, NumbersReadBackExactly) {
  for (const double value : {0.1, 1.0 / 3.0, 1e-9, 1e9, -4.000000000000001, 2.3e-308}) {
    EXPECT_EQ(std::stod(ValueText(value)), value);
  }
}

TEST(EffectiveValues, NameEveryParameterWithItsUnit) {
  const auto values = EffectiveValues(Paper({"arm.6.control.reference.alpha_per_tick=2"}));
  const auto find = [&](const std::string& key) {
    for (const EffectiveValue& value : values) {
      if (value.key == key) return value.value + " " + value.unit;
    }
    return std::string("none");
  };
  EXPECT_EQ(find("timing.period_s"), "0.01 s");
  EXPECT_EQ(find("arm.6.control.reference.alpha_per_tick"), "2 1/period");
  EXPECT_EQ(find("arm.7.link.3.I_kgm2"), "5 kg m^2");
  EXPECT_EQ(find("estimator.kind"), "\"predictive\" ");
}

TEST(EffectiveValues, KnowTheDefaultsBesideTheValues) {
  const auto values =
      EffectiveValues(Paper({"arm.6.control.reference.alpha_per_tick=2", "timing.period_s=0.02"}));
  const auto find = [&](const std::string& key) {
    for (const EffectiveValue& value : values) {
      if (value.key == key) return value.fallback + "; " + value.allowed;
    }
    return std::string("none");
  };
  EXPECT_EQ(find("timing.period_s"), "0.01; 1e-04 to 1");
  EXPECT_EQ(find("arm.6.control.reference.alpha_per_tick"), "4; 0.001 to 1000");
  EXPECT_EQ(find("arm.7.link.3.I_kgm2"), "required; 1e-09 to 10000");
  EXPECT_EQ(find("arm.7.q_min_rad"), "none; -1000 to 1000, or a list");
  EXPECT_EQ(find("estimator.kind"), "\"predictive\"; \"paper\", \"implicit\", \"predictive\"");
}

}  // namespace
}  // namespace armada
