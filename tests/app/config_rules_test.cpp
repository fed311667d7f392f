// Every rule of a fleet file, one mistake at a time: the error names the line, the key, what was given and
// what is allowed, and nothing else is reported.

#include <gtest/gtest.h>

#include "firmware/app/config/fleet_file.h"
#include "tests/app/config_support.h"

namespace armada {
namespace {

constexpr const char* kFleet = R"(name = "two"
topology_period_s = 0.0
[timing]
period_s = 0.01
[estimator]
kind = "predictive"
[link]
lcm_url = "udpm://239.255.76.67:7667?ttl=0"
[control]
law = "robust"
[[arm]]
id = 1
bus = "udp:239.74.163.11:43113"
torque_limit_Nm = 150
link = [
  { m_kg = 0.8, l_m = 1.4, r_m = 0.8, I_kgm2 = 6 },
  { m_kg = 0.6, l_m = 0.9, r_m = 0.45, I_kgm2 = 3 },
]
[[arm]]
id = 6
bus = "udp:239.74.163.16:43113"
torque_limit_Nm = [300, 300, 200]
link = [
  { m_kg = 0.8, l_m = 0.8, r_m = 0.4, I_kgm2 = 4 },
  { m_kg = 1.2, l_m = 1.1, r_m = 0.5, I_kgm2 = 6 },
  { m_kg = 1.4, l_m = 1.4, r_m = 0.7, I_kgm2 = 5 },
]
joint = [{}, {}, { gear_ratio = 9 }]
[arm.control.subtask]
kind = "posture"
[[graph]]
pins = [1]
edges = [{ from = 1, to = 6 }]
)";

std::string NameOfCase(const testing::TestParamInfo<ConfigCase>& tested) {
  return tested.param.name;
}

class FleetRule : public testing::TestWithParam<ConfigCase> {};

TEST_P(FleetRule, IsReportedWithItsLineAndWhatIsAllowed) {
  const ConfigCase& one = GetParam();
  const TemporaryFile file(WithLine(kFleet, one.line, one.replacement));
  std::vector<ConfigError> errors;
  EXPECT_FALSE(LoadFleet(file.path(), {}, &errors).has_value());
  ExpectOneError(one, file.path(), errors);
}

TEST(FleetRules, TheBaseOfTheseTestsBreaksNone) {
  const TemporaryFile file(kFleet);
  std::vector<ConfigError> errors;
  const auto fleet = LoadFleet(file.path(), {}, &errors);
  ASSERT_TRUE(fleet.has_value()) << Text(errors);
  EXPECT_EQ(fleet->arms[1].joints[2].node_id, 3);
  EXPECT_EQ(fleet->arms[1].joints[2].gear_ratio, 9.0);
  EXPECT_EQ(fleet->arms[1].joints[2].torque_limit_Nm, 200.0);
  EXPECT_EQ(fleet->arms[0].joints[1].torque_limit_Nm, 150.0);
}

const char* const kLongLink = "  { m_kg = 1, l_m = 1, r_m = 0.5, I_kgm2 = 5 },\n";

std::string Repeat(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

INSTANTIATE_TEST_SUITE_P(
    Text, FleetRule,
    testing::Values(
        ConfigCase{"BrokenToml", 4, "period_s = = 1", "", {}},
        ConfigCase{"DuplicateKey", 4, "period_s = 0.01\nperiod_s = 0.02", "", {"period_s"}, 5},
        ConfigCase{
            "UnknownKeyNearAKnownOne", 4, "perod_s = 0.01", "timing.perod_s", {"unknown", "\"period_s\""}},
        ConfigCase{"UnknownKeyNearNone",
                   4,
                   "colour = 3",
                   "timing.colour",
                   {"unknown", "period_s, sample_to_torque_s"}},
        ConfigCase{"UnknownKeyWithADot", 4, "\"a.b\" = 3", "timing.a.b", {"unknown"}},
        ConfigCase{"UnknownTable", 3, "[timings]", "timings", {"\"timing\""}},
        ConfigCase{"TextForANumber", 4, "period_s = \"fast\"", "timing.period_s", {"\"fast\"", "a number"}},
        ConfigCase{"NumberForText", 1, "name = 3", "name", {"given 3", "text"}},
        ConfigCase{"NumberForAnEnum", 6, "kind = 3", "estimator.kind", {"given 3", "\"implicit\""}},
        ConfigCase{
            "WrongNameForAnEnum", 10, "law = \"papr\"", "control.law", {"\"papr\"", "\"paper\", \"robust\""}},
        ConfigCase{
            "NumberForABool", 6, "leaderless = 0", "estimator.leaderless", {"given 0", "true or false"}},
        ConfigCase{
            "FractionForAnInteger", 6, "sync_ticks = 2.5", "estimator.sync_ticks", {"2.5", "whole number"}},
        ConfigCase{"DateForANumber", 4, "period_s = 2020-01-01", "timing.period_s", {"date", "a number"}},
        ConfigCase{"ListForANumber", 4, "period_s = [1, 2]", "timing.period_s", {"[1, 2]", "a number"}},
        ConfigCase{"TableForANumber", 4, "period_s = { s = 1 }", "timing.period_s", {"a table", "a number"}},
        ConfigCase{"NumberForATable", 10, "gains = 3", "control.gains", {"given 3", "a table"}},
        ConfigCase{
            "TableForAList", 32, "pins = { arm = 1 }", "graph.1.pins", {"a table", "a list of tables"}},
        ConfigCase{"TextInAListOfTables", 32, "pins = [\"one\"]", "graph.1.pins.1", {"\"one\"", "a table"}},
        ConfigCase{"TooSmall", 4, "period_s = 0", "timing.period_s", {"given 0", "1e-04 to 1 s"}},
        ConfigCase{"TooLarge", 4, "period_s = 1e9", "timing.period_s", {"1e+09", "1e-04 to 1 s"}},
        ConfigCase{"Infinite", 4, "period_s = inf", "timing.period_s", {"given inf", "1e-04 to 1 s"}},
        ConfigCase{"NotANumber", 4, "period_s = nan", "timing.period_s", {"given nan", "1e-04 to 1 s"}},
        ConfigCase{"HugeInteger",
                   6,
                   "sync_ticks = 9000000000000000000",
                   "estimator.sync_ticks",
                   {"1 to 1000 ticks"}},
        ConfigCase{"EmptyText", 1, "name = \"\"", "name", {"given \"\""}},
        ConfigCase{"MissingName", 1, "", "name", {"missing"}},
        ConfigCase{"MissingId", 12, "", "arm.1.id", {"missing"}, 11},
        ConfigCase{"MissingBus", 13, "", "arm.1.bus", {"missing"}, 11},
        ConfigCase{"MissingTorqueLimit", 14, "", "arm.1.torque_limit_Nm", {"missing"}, 11},
        ConfigCase{"MissingTorqueLimitOfOneJoint",
                   14,
                   "joint = [{ torque_limit_Nm = 1 }, {}]",
                   "arm.1.joint.2.torque_limit_Nm",
                   {"missing"}}),
    NameOfCase);

INSTANTIATE_TEST_SUITE_P(
    Fleet, FleetRule,
    testing::Values(
        ConfigCase{"SampleToTorqueNotBelowThePeriod",
                   4,
                   "period_s = 0.01\nsample_to_torque_s = 0.01",
                   "timing.sample_to_torque_s",
                   {"given 0.01 s", "below timing.period_s = 0.01 s"},
                   5},
        ConfigCase{"FeedbackTimeoutNotBelowThePeriod",
                   4,
                   "feedback_timeout_s = 0.02",
                   "timing.feedback_timeout_s",
                   {"given 0.02 s", "below timing.period_s"}},
        ConfigCase{"FeedbackStaleWithinThePeriod",
                   4,
                   "feedback_stale_s = 0.005",
                   "timing.feedback_stale_s",
                   {"given 0.005 s", "above timing.period_s"}},
        ConfigCase{
            "LcmUrl", 8, "lcm_url = \"udp://239.255.76.67:7667\"", "link.lcm_url", {"udp://", "udpm://"}},
        ConfigCase{"OtherMachinesWithoutAKey",
                   8,
                   "lcm_url = \"udpm://239.255.76.67:7667?ttl=1\"",
                   "link.lcm_url",
                   {"given ttl=1", "link.key_file", "armada key new"}},
        ConfigCase{"IdOutOfRange", 12, "id = 65", "arm.65.id", {"given 65", "1 to 64"}},
        ConfigCase{"IdTwice", 20, "id = 1", "arm.1.id", {"given 1", "line 11"}},
        ConfigCase{"BusName", 13, "bus = \"can0\"", "arm.1.bus", {"can0", "socketcan:<interface>"}},
        ConfigCase{"BusGroup", 13, "bus = \"udp:10.0.0.1:43113\"", "arm.1.bus", {"10.0.0.1", "multicast"}},
        ConfigCase{"BusInterfaceTooLong",
                   13,
                   "bus = \"socketcan:sixteen_letters_\"",
                   "arm.1.bus",
                   {"1 to 15 characters"}},
        ConfigCase{
            "BusTwice", 21, "bus = \"udp:239.74.163.11:43113?ttl=1\"", "arm.6.bus", {"ttl=1", "line 11"}},
        ConfigCase{"Drive",
                   13,
                   "bus = \"socketcan:can0\"\ndrive = \"ethercat\"",
                   "arm.1.drive",
                   {"\"ethercat\"", "\"odrive_cansimple\""},
                   14}),
    NameOfCase);

INSTANTIATE_TEST_SUITE_P(
    Arm, FleetRule,
    testing::Values(
        ConfigCase{
            "MissingMass", 17, "  { l_m = 0.9, r_m = 0.45, I_kgm2 = 3 },", "arm.1.link.2.m_kg", {"missing"}},
        ConfigCase{"MassNotPositive",
                   17,
                   "  { m_kg = 0, l_m = 0.9, r_m = 0.45, I_kgm2 = 3 },",
                   "arm.1.link.2.m_kg",
                   {"given 0", "1e-06 to 10000 kg"}},
        ConfigCase{"LengthNotPositive",
                   17,
                   "  { m_kg = 1, l_m = -0.9, r_m = 0.45, I_kgm2 = 3 },",
                   "arm.1.link.2.l_m",
                   {"given -0.9", "0.001 to 100 m"}},
        ConfigCase{"InertiaNotPositive",
                   17,
                   "  { m_kg = 1, l_m = 0.9, r_m = 0.45, I_kgm2 = 0 },",
                   "arm.1.link.2.I_kgm2",
                   {"given 0", "1e-09 to 10000 kg m^2"}},
        ConfigCase{"CentreOfMassInTheJoint",
                   17,
                   "  { m_kg = 1, l_m = 0.9, r_m = 0, I_kgm2 = 3 },",
                   "arm.1.link.2.r_m",
                   {"given 0", "1e-06"}},
        ConfigCase{"CentreOfMassBeyondTheLink",
                   17,
                   "  { m_kg = 1, l_m = 0.9, r_m = 0.91, I_kgm2 = 3 },",
                   "arm.1.link.2.r_m",
                   {"given 0.91 m", "l_m = 0.9 m"}},
        ConfigCase{"TooManyLinks", 16, Repeat(kLongLink, 7), "arm.1.link", {"given 8 links", "1 to 7"}, 15},
        ConfigCase{"TooManyJoints", 28, "joint = [{}, {}, {}, {}]", "arm.6.joint", {"given 4 joints", "3"}},
        ConfigCase{"TooFewJoints", 28, "joint = [{}]", "arm.6.joint", {"given 1 joints", "3"}},
        ConfigCase{"TooFewTorqueLimits",
                   22,
                   "torque_limit_Nm = [300, 300]",
                   "arm.6.torque_limit_Nm",
                   {"given 2 values", "3"}},
        ConfigCase{"TorqueLimitNotPositive",
                   22,
                   "torque_limit_Nm = [300, 300, 0]",
                   "arm.6.torque_limit_Nm.3",
                   {"given 0", "0.001 to 1e+05 N m"}},
        ConfigCase{"NodeIdTwice",
                   28,
                   "joint = [{}, {}, { node_id = 2 }]",
                   "arm.6.joint.3.node_id",
                   {"given 2", "joint 2"}},
        ConfigCase{"NodeIdOutOfRange",
                   28,
                   "joint = [{}, {}, { node_id = 64 }]",
                   "arm.6.joint.3.node_id",
                   {"given 64", "0 to 63"}},
        ConfigCase{"NodeIdOutOfItsProfilesRange",
                   28,
                   "joint = [{}, {}, { node_id = 16, drive = \"damiao\" }]",
                   "arm.6.joint.3.node_id",
                   {"given 16", "\"damiao\"", "1 to 15"}},
        ConfigCase{
            "NodesThatShareAnIdentifier",
            28,
            "joint = [{ drive = \"mini_cheetah\" }, { drive = \"mini_cheetah\", mit.master_id = 1 }, {}]",
            "arm.6.joint.2.node_id",
            {"identifier 0x001 of joint 1"}},
        ConfigCase{"Direction",
                   28,
                   "joint = [{}, { direction = 0.5 }, {}]",
                   "arm.6.joint.2.direction",
                   {"given 0.5", "1 and -1"}},
        ConfigCase{"GearRatioNotPositive",
                   28,
                   "joint = [{}, { gear_ratio = -9 }, {}]",
                   "arm.6.joint.2.gear_ratio",
                   {"given -9", "0.001 to 10000"}}),
    NameOfCase);

INSTANTIATE_TEST_SUITE_P(
    Law, FleetRule,
    testing::Values(ConfigCase{"GainNotPositive",
                               29,
                               "[arm.control.gains]\nK_s_Nms_rad = 0\n[arm.control.subtask]",
                               "arm.6.control.gains.K_s_Nms_rad",
                               {"given 0", "1e-06"},
                               30},
                    ConfigCase{"OneGainOfAListNotPositive",
                               29,
                               "[arm.control.gains]\nK_s_Nms_rad = [1, 2, -3]\n[arm.control.subtask]",
                               "arm.6.control.gains.K_s_Nms_rad.3",
                               {"given -3"},
                               30},
                    ConfigCase{"TooFewGains",
                               29,
                               "[arm.control.gains]\nK_s_Nms_rad = [1, 2]\n[arm.control.subtask]",
                               "arm.6.control.gains.K_s_Nms_rad",
                               {"given 2 values", "arm 6", "3"},
                               30},
                    ConfigCase{"TooManyAxes",
                               29,
                               "[arm.control.gains]\nK_x_Ns_m = [1, 2, 3]\n[arm.control.subtask]",
                               "arm.6.control.gains.K_x_Ns_m",
                               {"given 3 values", "2"},
                               30},
                    ConfigCase{
                        "EightGains",
                        29,
                        "[arm.control.gains]\nK_r_Nm = [1, 2, 3, 4, 5, 6, 7, 8]\n[arm.control.subtask]",
                        "arm.6.control.gains.K_r_Nm",
                        {"given 8 values", "1 to 7"},
                        30},
                    ConfigCase{"GainsOfTheFleetFitOneArmOnly",
                               10,
                               "gains = { K_r_Nm = [60, 60] }",
                               "control.gains.K_r_Nm",
                               {"given 2 values", "arm 6", "3"}},
                    ConfigCase{"SubtaskWithoutSpareJoints",
                               10,
                               "[control.subtask]\nkind = \"manipulability\"",
                               "control.subtask.kind",
                               {"\"manipulability\"", "arm 1 has 2", "\"none\""},
                               11},
                    ConfigCase{"SubtaskJointBeyondTheArm",
                               30,
                               "kind = \"posture\"\njoint = 4",
                               "arm.6.control.subtask.joint",
                               {"given 4", "1 to 3"},
                               31}),
    NameOfCase);

INSTANTIATE_TEST_SUITE_P(
    LimitsAndObstacles, FleetRule,
    testing::Values(
        ConfigCase{"LimitsOfTwoOfThreeJoints",
                   22,
                   "torque_limit_Nm = 300\nq_max_rad = [1, 2]",
                   "arm.6.q_max_rad",
                   {"given 2 values", "one a joint, 3"},
                   23},
        ConfigCase{"LimitsTheWrongWayRound",
                   22,
                   "torque_limit_Nm = 300\nq_min_rad = [-1, 2, -1]\nq_max_rad = 2",
                   "arm.6.q_min_rad",
                   {"given 2 rad for joint 2", "q_max_rad = 2", "two margins of 0.05"},
                   23},
        ConfigCase{"GoalBeyondTheLimit",
                   22,
                   "torque_limit_Nm = 300\nq_max_rad = 0.02",
                   "arm.6.control.subtask.goal_rad",
                   {"given 0 rad", "at least 0.05 rad within the limits of joint 1"},
                   30},
        ConfigCase{"LimitsWithoutSpareJoints",
                   14,
                   "torque_limit_Nm = 150\nq_max_rad = 2",
                   "arm.1.q_max_rad",
                   {"arm 1, which has 2 joints", "more than 2 joints", "avoidance.enabled = false"},
                   15},
        ConfigCase{"ObstaclesWithoutSpareJoints",
                   14,
                   "torque_limit_Nm = 150\nobstacle = [{ x_m = 9 }]",
                   "arm.1.obstacle",
                   {"arm 1, which has 2 joints", "more than 2 joints"},
                   15},
        ConfigCase{"ObstaclesAndTheLawAsPrinted",
                   29,
                   "[arm.control]\nlaw = \"paper\"\n[[arm.obstacle]]\nx_m = 9\n[arm.control.subtask]",
                   "arm.6.obstacle",
                   {"law \"paper\"", "law \"robust\""},
                   31},
        ConfigCase{"NineObstacles",
                   22,
                   "torque_limit_Nm = 300\nobstacle = [{ x_m = 9 }, { x_m = 9 }, { x_m = 9 }, { x_m = 9 }, "
                   "{ x_m = 9 }, { x_m = 9 }, { x_m = 9 }, { x_m = 9 }, { x_m = 9 }]",
                   "arm.6.obstacle",
                   {"given 9 obstacles", "up to 8"},
                   23},
        ConfigCase{"BaseWithinADisc",
                   22,
                   "torque_limit_Nm = 300\nobstacle = [{ x_m = 9 }, { x_m = 0.12, radius_m = 0.1 }]",
                   "arm.6.obstacle.2",
                   {"0.02 m from the arm's base", "clearance, 0.05 m"},
                   23},
        ConfigCase{"BaseBehindAWall",
                   22,
                   "torque_limit_Nm = 300\nobstacle = [{ kind = \"half_plane\", x_m = 0.1 }]",
                   "arm.6.obstacle.1",
                   {"-0.1 m from the arm's base"},
                   23},
        ConfigCase{"ObstacleOfNoKnownKind",
                   22,
                   "torque_limit_Nm = 300\nobstacle = [{ kind = \"box\" }]",
                   "arm.6.obstacle.1.kind",
                   {"given \"box\"", "\"disc\", \"half_plane\""},
                   23},
        ConfigCase{"AvoidanceFasterThanThePeriod",
                   29,
                   "[[arm.obstacle]]\nx_m = 9\n[arm.control.subtask]\navoidance.rate_1_s = 101",
                   "arm.6.control.subtask.avoidance.rate_1_s",
                   {"given 101", "1 / timing.period_s = 100"},
                   32}),
    NameOfCase);

INSTANTIATE_TEST_SUITE_P(
    ReachAndProjection, FleetRule,
    testing::Values(
        ConfigCase{"MarginsLeaveNoReach",
                   10,
                   "reference = { reach_inner_margin_m = 1.8 }",
                   "control.reference.reach_inner_margin_m",
                   {"arm 1", "2.3", "allowed is less together than 1.8 m"}},
        ConfigCase{"InertiaBoundsOutOfOrder",
                   10,
                   "projection = { inertia_min_kgm2 = 40 }",
                   "control.projection.inertia_min_kgm2",
                   {"given 40", "inertia_max_kgm2 = 40"}},
        ConfigCase{"GravityBoundsOutOfOrder",
                   10,
                   "projection = { gravity_min_kgm = 0, gravity_max_kgm = 0 }",
                   "control.projection.gravity_min_kgm",
                   {"given 0", "gravity_max_kgm = 0"}},
        ConfigCase{"InertiaBelowTheSet",
                   29,
                   "[arm.control]\nprojection = { inertia_min_kgm2 = 5.7 }\n[arm.control.subtask]",
                   "arm.6.control.projection.inertia_min_kgm2",
                   {"given 5.7", "D_33 = 5.686", "at most 5.68"},
                   30},
        ConfigCase{"InertiaAboveTheSet",
                   29,
                   "[arm.control]\nprojection = { inertia_max_kgm2 = 7.9 }\n[arm.control.subtask]",
                   "arm.6.control.projection.inertia_max_kgm2",
                   {"given 7.9", "D_22 = 7.994", "at least 7.99"},
                   30},
        ConfigCase{"CouplingBeyondTheSet",
                   10,
                   "projection = { correlation_max = 0.4 }",
                   "control.projection.correlation_max",
                   {"given 0.4", "arm 6", "= 0.503", "at least 0.504"}}),
    NameOfCase);

INSTANTIATE_TEST_SUITE_P(
    Graph, FleetRule,
    testing::Values(
        ConfigCase{"PinsAnUnknownArm", 32, "pins = [1, 2]", "graph.1.pins.2.arm", {"given 2", "1, 6"}},
        ConfigCase{"PinsAnArmTwice",
                   32,
                   "pins = [1, { arm = 1, weight = 2 }]",
                   "graph.1.pins.2.arm",
                   {"given 1 twice"}},
        ConfigCase{"PinWithNegativeWeight",
                   32,
                   "pins = [{ arm = 1, weight = -1 }]",
                   "graph.1.pins.1.weight",
                   {"given -1", "0 to 1000"}},
        ConfigCase{"EdgeFromAnUnknownArm",
                   33,
                   "edges = [{ from = 2, to = 6 }]",
                   "graph.1.edges.1.from",
                   {"given 2", "1, 6"}},
        ConfigCase{"EdgeToAnUnknownArm",
                   33,
                   "edges = [{ from = 1, to = 6 }, { from = 1, to = 7 }]",
                   "graph.1.edges.2.to",
                   {"given 7", "1, 6"}},
        ConfigCase{"EdgeToItself",
                   33,
                   "edges = [{ from = 1, to = 6 }, { from = 6, to = 6 }]",
                   "graph.1.edges.2",
                   {"arm 6 to itself", "eps_ii"}},
        ConfigCase{"EdgeTwice",
                   33,
                   "edges = [{ from = 1, to = 6 }, { from = 1, to = 6 }]",
                   "graph.1.edges.2",
                   {"from arm 1 to arm 6 twice"}},
        ConfigCase{"EdgeWithNegativeWeight",
                   33,
                   "edges = [{ from = 1, to = 6, weight = -0.1 }]",
                   "graph.1.edges.1.weight",
                   {"given -0.1", "0 to 1000"}},
        ConfigCase{"EdgeWithoutAnEnd", 33, "edges = [{ from = 1 }]", "graph.1.edges.1.to", {"missing"}},
        ConfigCase{"UnreachedArm", 33, "edges = []", "graph.1", {"does not reach arm 6", "A1"}, 31},
        ConfigCase{"UnreachedByAWeightOfZero",
                   33,
                   "edges = [{ from = 1, to = 6, weight = 0 }]",
                   "graph.1",
                   {"does not reach arm 6", "A1"},
                   31},
        ConfigCase{"PinsOfALeaderlessFleet", 6, "leaderless = true", "graph.1.pins", {"leaderless"}, 32},
        ConfigCase{"PeriodOfASingleTopology",
                   2,
                   "topology_period_s = 0.5",
                   "topology_period_s",
                   {"given 0.5 s", "one [[graph]]"}}),
    NameOfCase);

// Rules that need another base than the one above.

std::vector<ConfigError> ErrorsOf(const std::string& text, std::string* file) {
  const TemporaryFile fleet(text);
  *file = fleet.path();
  std::vector<ConfigError> errors;
  EXPECT_FALSE(LoadFleet(fleet.path(), {}, &errors).has_value());
  return errors;
}

std::string ArmText(int id, const std::string& links) {
  return "[[arm]]\nid = " + std::to_string(id) + "\nbus = \"socketcan:can" + std::to_string(id) +
         "\"\ntorque_limit_Nm = 150\nlink = [" + links + "]\n";
}

const std::string kHeavyLink = "{ m_kg = 1, l_m = 1, r_m = 0.5, I_kgm2 = 5 }";

TEST(FleetRules, AFleetHasArmsAndAGraph) {
  std::string file;
  const auto no_arms = ErrorsOf("name = \"none\"\n", &file);
  ExpectOneError({"", 1, "", "arm", {"no arm", "1 to 64"}}, file, no_arms);
  const auto no_graph = ErrorsOf("name = \"none\"\n" + ArmText(1, kHeavyLink), &file);
  ExpectOneError({"", 1, "", "graph", {"given 0 topologies", "1 to 16"}}, file, no_graph);
}

TEST(FleetRules, AnArmHasLinks) {
  std::string file;
  const auto errors = ErrorsOf("name = \"x\"\n" + ArmText(1, "") + "[[graph]]\npins = [1]\n", &file);
  ExpectOneError({"", 6, "", "arm.1.link", {"given 0 links", "1 to 7"}}, file, errors);
}

TEST(FleetRules, ThePapersLawNeedsTwoJoints) {
  std::string file;
  const std::string text =
      "name = \"x\"\n" + ArmText(3, kHeavyLink) + "[arm.control]\nlaw = \"paper\"\n[[graph]]\npins = [3]\n";
  ExpectOneError(
      {"", 8, "", "arm.3.control.law", {"\"paper\"", "at least 2 joints", "arm 3 has 1", "\"robust\""}}, file,
      ErrorsOf(text, &file));
}

TEST(FleetRules, GravityMomentsLieInTheProjectionSet) {
  std::string file;
  const std::string text = "name = \"x\"\n" + ArmText(3, kHeavyLink + ", " + kHeavyLink) +
                           "gravity_m_s2 = 9.81\n[arm.control]\nprojection = { gravity_max_kgm = 1.25 }\n" +
                           "[[graph]]\npins = [3]\n";
  ExpectOneError(
      {"", 9, "", "arm.3.control.projection.gravity_max_kgm", {"given 1.25", "G_1 = 1.5", "at least"}}, file,
      ErrorsOf(text, &file));
}

TEST(FleetRules, ALeaderlessFleetHasATree) {
  std::string file;
  const std::string text = "name = \"x\"\nestimator.leaderless = true\n" + ArmText(1, kHeavyLink) +
                           ArmText(2, kHeavyLink) + ArmText(3, kHeavyLink) +
                           "[[graph]]\nedges = [{ from = 1, to = 2 }, { from = 3, to = 2 }]\n";
  ExpectOneError({"", 18, "", "graph.1", {"Corollary 2"}}, file, ErrorsOf(text, &file));
}

TEST(FleetRules, SeveralTopologiesHaveAPeriod) {
  std::string file;
  const std::string rest =
      ArmText(1, kHeavyLink) + "[[graph]]\npins = [1]\n[[graph]]\npins = [{ arm = 1, weight = 2 }]\n";
  ExpectOneError({"", 1, "", "topology_period_s", {"given 0 s", "2 [[graph]]", "at least timing.period_s"}},
                 file, ErrorsOf("name = \"x\"\n" + rest, &file));
  ExpectOneError({"", 2, "", "topology_period_s", {"given 0.005 s"}}, file,
                 ErrorsOf("name = \"x\"\ntopology_period_s = 0.005\n" + rest, &file));
}

TEST(FleetRules, EveryTopologyReachesAllArms) {
  std::string file;
  std::string text = WithLine(kFleet, 2, "topology_period_s = 0.5");
  text = WithLine(text, 33, "edges = [{ from = 1, to = 6 }]\n[[graph]]\npins = [6]");
  ExpectOneError({"", 34, "", "graph.2", {"does not reach arm 1", "A1"}}, file, ErrorsOf(text, &file));
}

// Not each, but all in turn before the news of the leader count as lost.
TEST(FleetRules, TopologiesMayReachAllArmsTogether) {
  std::string file;
  std::string text = WithLine(kFleet, 2, "topology_period_s = 0.09");
  text = WithLine(text, 33, "[[graph]]\nedges = [{ from = 1, to = 6 }]");
  std::vector<ConfigError> none;
  const TemporaryFile in_time(text, "in_time.toml");
  EXPECT_TRUE(LoadFleet(in_time.path(), {}, &none).has_value()) << Text(none);
  text = WithLine(text, 2, "topology_period_s = 0.1");
  const auto errors = ErrorsOf(text, &file);
  ASSERT_EQ(errors.size(), 2u) << Text(errors);
  EXPECT_EQ(
      ToString(errors[0]),
      file +
          ":31: graph.1: the leader does not reach arm 6; assumption A1 asks for a path of pins and edges to "
          "every arm, in each topology or in all together in good time: the news of the leader at arm 6 get "
          "0.21 s old, and estimator.age_max_s = 0.2 s");
}

TEST(FleetRules, NewsOfTheLeaderArriveInTime) {
  std::string file;
  const std::string text = WithLine(kFleet, 6, "age_max_s = 0.01");
  ExpectOneError({"", 31, "", "graph.1", {"arm 6 get 0.02 s old", "estimator.age_max_s = 0.01 s"}}, file,
                 ErrorsOf(text, &file));
}

TEST(FleetRules, TopologiesAreAtMostSixteen) {
  std::string file;
  const std::string text = "name = \"x\"\ntopology_period_s = 1\n" + ArmText(1, kHeavyLink) +
                           Repeat("[[graph]]\npins = [1]\n", 17);
  ExpectOneError({"", 8, "", "graph", {"given 17", "1 to 16"}}, file, ErrorsOf(text, &file));
}

TEST(FleetRules, ArmsAreAtMostSixtyFour) {
  std::string arms;
  for (int id = 1; id <= 65; ++id) arms += ArmText(id, kHeavyLink);
  std::string file;
  const auto errors = ErrorsOf("name = \"x\"\n" + arms + "[[graph]]\npins = [1]\n", &file);
  EXPECT_NE(Text(errors).find("arm: given 65 arms, allowed are 1 to 64"), std::string::npos) << Text(errors);
}

TEST(FleetRules, AllMistakesAreReportedAtOnceInTheOrderOfTheFile) {
  std::string text = WithLine(kFleet, 4, "period_s = -1");
  text = WithLine(text, 17, "  { m_kg = 0.6, l_m = 0.9, r_m = 0.5, I_kgm2 = 3, colour = 1 },");
  text = WithLine(text, 24, "  { m_kg = 0.8, l_m = 0.8, r_m = 0.9, I_kgm2 = 4 },");
  text = WithLine(text, 32, "pins = [5]");
  std::string file;
  const auto errors = ErrorsOf(text, &file);
  std::vector<std::string> keys;
  for (const ConfigError& error : errors) keys.push_back(std::to_string(error.line) + " " + error.key);
  const std::vector<std::string> expected = {"4 timing.period_s", "17 arm.1.link.2.colour",
                                             "24 arm.6.link.1.r_m", "32 graph.1.pins.1.arm"};
  EXPECT_EQ(keys, expected) << Text(errors);
}

}  // namespace
}  // namespace armada
