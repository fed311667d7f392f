// What a scenario may not say of its faults, and what the documentation says of them.

#include "hil/fault_rules.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "hil/fault_meaning.h"
#include "hil/scenario_file.h"
#include "tests/app/config_support.h"

namespace armada {
namespace {

const std::string kSourceFolder = ARMADA_SOURCE_DIR;

// Line 3 begins the fault.
std::string WithFault(const std::string& fault) {
  return "name = \"test\"\nbase = \"" + kSourceFolder + "/hil/scenarios/paper.toml\"\n[[fault]]\n" + fault +
         "\n";
}

class FaultRule : public testing::TestWithParam<ConfigCase> {};

TEST_P(FaultRule, IsReportedWithItsLineAndWhatIsAllowed) {
  const ConfigCase& one = GetParam();
  const TemporaryFile file(WithFault(one.replacement));
  std::vector<ConfigError> errors;
  EXPECT_FALSE(LoadScenario(file.path(), {}, &errors).has_value());
  ExpectOneError(one, file.path(), errors);
}

INSTANTIATE_TEST_SUITE_P(
    All, FaultRule,
    testing::Values(
        ConfigCase{"NoKind", 3, "at_s = 1.0\narm = 1", "fault.1.kind", {"missing"}},
        ConfigCase{"UnknownKind",
                   4,
                   "kind = \"bus_of\"\nat_s = 1.0\narm = 1",
                   "fault.1.kind",
                   {"\"bus_of\"", "\"bus_off\""}},
        ConfigCase{"NoTime", 3, "kind = \"bus_off\"\narm = 1", "fault.1.at_s", {"missing"}},
        ConfigCase{"UnknownArm",
                   6,
                   "kind = \"bus_off\"\nat_s = 1.0\narm = 9",
                   "fault.1.arm",
                   {"given 9", "with kind = \"bus_off\"", "1, 2, 3, 4, 5, 6, 7"}},
        ConfigCase{"NoArm", 3, "kind = \"bus_off\"\nat_s = 1.0", "fault.1.arm", {"given 0", "the arms 1"}},
        ConfigCase{"ArmOfALeadersFault",
                   6,
                   "kind = \"leader_dies\"\nat_s = 1.0\narm = 1",
                   "fault.1.arm",
                   {"given 1", "is 0, the leader"}},
        ConfigCase{"UnknownJoint",
                   7,
                   "kind = \"drive_error\"\nat_s = 1.0\narm = 2\njoint = 3",
                   "fault.1.joint",
                   {"given 3", "1 to 2 of arm 2"}},
        ConfigCase{"JointOfABus",
                   7,
                   "kind = \"bus_off\"\nat_s = 1.0\narm = 2\njoint = 1",
                   "fault.1.joint",
                   {"given 1", "is none"}},
        ConfigCase{"OverBeforeItBegins",
                   6,
                   "kind = \"bus_off\"\nat_s = 1.0\nuntil_s = 1.0\narm = 1",
                   "fault.1.until_s",
                   {"given 1 s", "above at_s = 1 s"}},
        ConfigCase{"EndOfDeath",
                   6,
                   "kind = \"controller_dies\"\nat_s = 1.0\nuntil_s = 2.0\narm = 1",
                   "fault.1.until_s",
                   {"given 2 s", "is none"}},
        ConfigCase{"RestartWithoutATime",
                   3,
                   "kind = \"controller_restarts\"\nat_s = 1.0\narm = 1",
                   "fault.1.until_s",
                   {"missing", "goes on"}},
        ConfigCase{"DriveWithoutASignal",
                   3,
                   "kind = \"drive\"\nat_s = 1.0\narm = 1\nway = \"off\"",
                   "fault.1.signal",
                   {"missing"}},
        ConfigCase{"DriveWithoutAWay",
                   3,
                   "kind = \"drive\"\nat_s = 1.0\narm = 1\nsignal = \"status\"",
                   "fault.1.way",
                   {"missing"}},
        ConfigCase{"SignalOfABus",
                   7,
                   "kind = \"bus_off\"\nat_s = 1.0\narm = 1\nsignal = \"status\"",
                   "fault.1.signal",
                   {"given \"status\"", "is none"}},
        ConfigCase{
            "NoValue", 3, "kind = \"bus_loss\"\nat_s = 1.0\narm = 1", "fault.1.value", {"missing", "share"}},
        ConfigCase{"ShareAboveOne",
                   7,
                   "kind = \"bus_loss\"\nat_s = 1.0\narm = 1\nvalue = 1.5",
                   "fault.1.value",
                   {"given 1.5", "1e-06 to 1"}},
        ConfigCase{"ValueOfNothing",
                   7,
                   "kind = \"bus_off\"\nat_s = 1.0\narm = 1\nvalue = 1.5",
                   "fault.1.value",
                   {"given 1.5", "is none"}},
        ConfigCase{
            "ValueOfAWayThatHasNone",
            9,
            "kind = \"drive\"\nat_s = 1.0\narm = 1\nsignal = \"position\"\nway = \"stuck\"\nvalue = 1.0",
            "fault.1.value",
            {"given 1", "way = \"stuck\" is none"}},
        ConfigCase{
            "DelayBeyondTheMemory",
            9,
            "kind = \"drive\"\nat_s = 1.0\narm = 1\nsignal = \"velocity\"\nway = \"delayed\"\nvalue = 0.2",
            "fault.1.value",
            {"given 0.2", "0.001 to 0.1", "the delay, s"}},
        ConfigCase{"StatusOfADriveThatTellsNone",
                   7,
                   "kind = \"drive\"\nat_s = 1.0\narm = 1\nsignal = \"status\"\nway = \"off\"\n[overrides]\n"
                   "\"arm.1.drive\" = \"mini_cheetah\"",
                   "fault.1.signal",
                   {"\"mini_cheetah\"", "nothing of its own"}}),
    [](const testing::TestParamInfo<ConfigCase>& tested) { return tested.param.name; });

TEST(FaultRules, AFaultOfTheLeaderNeedsOne) {
  std::vector<ConfigError> errors;
  EXPECT_FALSE(LoadScenario(kSourceFolder + "/hil/scenarios/leaderless.toml",
                            {"fault=[{kind=\"leader_dies\",at_s=1.0}]"}, &errors));
  EXPECT_NE(Text(errors).find("fault.1.arm: meant for the leader, but there is none"), std::string::npos)
      << Text(errors);
}

TEST(FaultMeaning, EveryKindHasOne) {
  for (const auto& [kind, name] : EnumNames(FaultKind{})) EXPECT_EQ(MeaningOf(kind).kind, kind) << name;
}

TEST(FaultMeaning, IsWhatTheDocumentationSays) {
  std::ifstream stream(kSourceFolder + "/docs/faults.md");
  std::stringstream committed;
  committed << stream.rdbuf();
  EXPECT_NE(committed.str().find(FaultTables()), std::string::npos)
      << "docs/faults.md is out of date; its tables are\n"
      << FaultTables();
}

}  // namespace
}  // namespace armada
