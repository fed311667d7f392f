#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "host/check.h"
#include "host/check/bus_load.h"
#include "host/check/check_output.h"
#include "host/check/check_result.h"
#include "tests/host/paper_scenario.h"

namespace armada {
namespace {

TEST(SensorCheck, DrivesThatMeasureWorseThanTheLawBelievesAreNamed) {
  ScenarioConfig scenario = PaperScenario();
  EXPECT_FALSE(Mentions(BuildCheck(scenario), Severity::kWarning, "is worse than control.sensor"));
  scenario.drive.velocity_noise_rad_s = 0.02;
  EXPECT_TRUE(Mentions(BuildCheck(scenario), Severity::kWarning, "arm 6: joint 3's velocity is worse"));
  for (ArmEntry& arm : scenario.fleet.arms) arm.control.sensor.velocity_deviation_rad_s.setConstant(0.02);
  EXPECT_FALSE(Mentions(BuildCheck(scenario), Severity::kWarning, "is worse than control.sensor"));
  scenario.drive.encoder_counts_per_turn = 4096;
  EXPECT_TRUE(Mentions(BuildCheck(scenario), Severity::kWarning, "joint 1's encoder is worse"));
}

TEST(MarginCheck, BetaStandsAgainstTheLeadersBoundsAndGivesTheTimeBound) {
  const ScenarioConfig scenario = PaperScenario();
  const EstimatorCheck check = CheckEstimator(scenario, LeaderPath(scenario.leader));
  EXPECT_TRUE(check.holds());
  EXPECT_NEAR(check.margins[0].ratio(), 4.0 / (0.5 * M_PI), 1e-12);
  // Slowest is v: from +-5 around zero to (pi/2, 0), closing at 7 - pi^2/2.
  EXPECT_NEAR(check.settled_max_s, (5.0 + 0.5 * M_PI) / (7.0 - 0.5 * M_PI * M_PI), 1e-12);
}

TEST(MarginCheck, StartsNearTheLeaderSettleSooner) {
  ScenarioConfig scenario = PaperScenario();
  scenario.start.kind = StartKind::kNearLeader;
  scenario.start.zeta_range = 0.2;
  const EstimatorCheck check = CheckEstimator(scenario, LeaderPath(scenario.leader));
  EXPECT_NEAR(check.settled_max_s, 0.2 / (7.0 - 0.5 * M_PI * M_PI), 1e-12);
}

TEST(MarginCheck, BoxOfStartsMayLieElsewhere) {
  ScenarioConfig scenario = PaperScenario();
  scenario.start.zeta_x_centre_m << -20.0, 0.0;
  const EstimatorCheck check = CheckEstimator(scenario, LeaderPath(scenario.leader));
  EXPECT_NEAR(check.settled_max_s, (5.0 + 21.2) / (4.0 - 0.5 * M_PI), 1e-12);
}

TEST(MarginCheck, BetaBelowTheLeaderFailsAndSettlesNever) {
  ScenarioConfig scenario = PaperScenario();
  scenario.fleet.estimator.beta_2_m_s2 = 4.9;  // the leader's 4.935
  const CheckResult result = BuildCheck(scenario);
  EXPECT_FALSE(result.ok());
  EXPECT_FALSE(result.estimator->margins[1].holds());
  EXPECT_TRUE(std::isinf(result.estimator->settled_max_s));
}

TEST(MarginCheck, KrIsHeldAgainstTheTwoNormOfTheDisturbance) {
  const CheckResult result = BuildCheck(PaperScenario());
  EXPECT_TRUE(result.ok()) << "a missed condition is a warning";
  for (const ArmCheck& arm : result.arms) {
    EXPECT_NEAR(arm.disturbance->d_2norm_Nm, 40.0 * std::sqrt(arm.dof), 1e-12);
    EXPECT_EQ(arm.disturbance->holds(), arm.dof == 2);
    EXPECT_EQ(Mentions(result, Severity::kWarning, "arm " + std::to_string(arm.id) + ": K_r"), arm.dof == 3);
  }
}

TEST(MarginCheck, WithoutDisturbanceAnyKrSuffices) {
  ScenarioConfig scenario = PaperScenario();
  scenario.disturbance.kind = DisturbanceKind::kNone;
  EXPECT_FALSE(Mentions(BuildCheck(scenario), Severity::kWarning, "K_r"));
}

TEST(PathCheck, Arm5ComesWithinSixteenMillimetresOfItsReach) {
  const ScenarioConfig scenario = PaperScenario();
  const ArmEntry& arm5 = scenario.fleet.arms[4];
  const PathCheck check = CheckPath(scenario, arm5, LeaderPath(scenario.leader));
  EXPECT_NEAR(check.reach_outer_m, 0.016, 5e-4);
  EXPECT_NEAR(check.sigma_min, 0.1152, 1e-3);  // by the law of cosines, at the radius of 2.1841 m
  EXPECT_TRUE(Mentions(BuildCheck(scenario), Severity::kWarning, "arm 5: comes near a singularity"));
}

// A circle about the base at constant speed turns a two-link arm as a rigid body: the elbow does not move,
// and all that the torque has to do is nothing. Off the centre the law of cosines gives sigma_min.
TEST(PathCheck, CircleAboutTheBaseNeedsTheDisturbancesTorqueOnly) {
  ScenarioConfig scenario = PaperScenario();
  scenario.leader.axes = {{0.0, 1.5, 0.2, M_PI / 2}, {0.0, 1.5, 0.2, 0.0}};
  const ArmEntry& arm = scenario.fleet.arms[0];  // links of 1.4 and 0.9 m
  const PathCheck check = CheckPath(scenario, arm, LeaderPath(scenario.leader));
  EXPECT_NEAR(check.reach_outer_m, 2.3 - 1.5, 1e-9);
  EXPECT_NEAR(check.reach_inner_m, 1.5 - 0.5, 1e-9);
  // The elbow carries the centrifugal force, the shoulder nothing: C(q, dq) dq = D_12 sin(q_2) w^2 (0, 1).
  const double cosine = (1.5 * 1.5 - 1.4 * 1.4 - 0.9 * 0.9) / (2.0 * 1.4 * 0.9);
  const double w = 2.0 * M_PI * 0.2;
  const double elbow_Nm = 0.6 * 1.4 * 0.45 * std::sqrt(1.0 - cosine * cosine) * w * w;
  EXPECT_NEAR(check.torques[0].needed_Nm, 40.0, 0.05);
  EXPECT_NEAR(check.torques[1].needed_Nm, 40.0 + elbow_Nm, 0.05);
  EXPECT_LT(check.error_m, 1e-3);
  // det(J) = l1 l2 sin(q2) = sigma_1 sigma_2, |J|_F^2 = sigma_1^2 + sigma_2^2 = r^2 + l2^2.
  const double det = 1.4 * 0.9 * std::sqrt(1.0 - cosine * cosine);
  const double squares = 1.5 * 1.5 + 0.9 * 0.9;
  EXPECT_NEAR(check.sigma_min, std::sqrt(0.5 * (squares - std::sqrt(squares * squares - 4.0 * det * det))),
              1e-3);
}

TEST(PathCheck, RestingArmNeedsTheTorqueOfGravity) {
  ScenarioConfig scenario = PaperScenario();
  scenario.disturbance.kind = DisturbanceKind::kNone;
  scenario.leader = {};
  scenario.leader.kind = LeaderKind::kWaypoints;
  scenario.leader.waypoints_m = {{1.4, 0.9}};
  ArmEntry arm = scenario.fleet.arms[0];
  arm.arm.gravity_m_s2 = 9.81;
  const PathCheck check = CheckPath(scenario, arm, LeaderPath(scenario.leader));
  // One of the two elbows: first link along x, second up, its centre of mass above the elbow.
  const double shoulder_Nm = 9.81 * (0.8 * 0.8 + 0.6 * 1.4);
  EXPECT_GE(check.torques[0].needed_Nm, shoulder_Nm - 1e-3);
  EXPECT_GT(check.torques[1].needed_Nm, 0.0);
  EXPECT_LT(check.error_m, 1e-6);
}

TEST(PathCheck, LeaderBeyondTheReachIsAnErrorThatSaysByHowMuch) {
  ScenarioConfig scenario = PaperScenario();
  scenario.leader.axes = {{2.4, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.0, 0.0}};
  const CheckResult result = BuildCheck(scenario);
  EXPECT_FALSE(result.ok());
  EXPECT_NEAR(result.arms[0].path->reach_outer_m, -0.1, 1e-12);
  EXPECT_TRUE(
      Mentions(result, Severity::kError, "arm 1: would miss the leader by 10"));  // 105 mm with the margin
  EXPECT_FALSE(Mentions(result, Severity::kError, "arm 6"));                      // reaches 3.3 m
}

TEST(PathCheck, LimitBelowTheNeedIsAWarning) {
  ScenarioConfig scenario = PaperScenario();
  scenario.fleet.arms[1].joints[1].torque_limit_Nm = 41.0;
  const CheckResult result = BuildCheck(scenario);
  EXPECT_TRUE(Mentions(result, Severity::kWarning, "arm 2: joint 2 needs"));
  EXPECT_EQ(result.arms[1].path->WorstJoint(), 1u);
}

/// The paper's scenario with a posture for arm 6.
ScenarioConfig WithPosture(int joint, double goal_rad) {
  ScenarioConfig scenario = PaperScenario();
  SubtaskConfig& subtask = scenario.fleet.arms[5].control.subtask;
  subtask.kind = SubtaskKind::kPosture;
  subtask.joint = joint;
  subtask.goal_rad = goal_rad;
  subtask.gain = 9.0;
  return scenario;
}
PostureCheck CheckOfPosture(int joint, double goal_rad) {
  const ScenarioConfig scenario = WithPosture(joint, goal_rad);
  return CheckPosture(scenario, scenario.fleet.arms[5], LeaderPath(scenario.leader));
}

// The leader is 1.38 to 2.18 m from the base; links of 0.8, 1.1 and 1.4 m.
TEST(PostureCheck, OfArm6IsAttainableFromEveryStart) {
  const PostureCheck check = CheckOfPosture(2, 1.0);
  EXPECT_TRUE(check.attainable());
  EXPECT_TRUE(check.from_every_start());
  EXPECT_EQ(check.stretched, 1.0);  // 1.9 m is at most 1.4 m from each of those radii
  EXPECT_GT(check.folded, 0.1);     // 0.3 m is so below 1.7 m only
  EXPECT_LT(check.folded, 0.9);
}

TEST(PostureCheck, AJointThatTheLeaderTakesAlongHasItsGoalOnAShareOfThePath) {
  // Folded second joint: within 1.7 m of the base.
  const PostureCheck check = CheckOfPosture(2, std::numbers::pi);
  EXPECT_FALSE(check.attainable());
  EXPECT_EQ(check.at_goal, check.folded);
  // First link away from the leader: 0.8 m and the radius within 2.5 m.
  EXPECT_LT(CheckOfPosture(1, 0.8 + std::numbers::pi).at_goal, 0.9);
  EXPECT_EQ(CheckOfPosture(1, 0.8).at_goal, 1.0);
}

TEST(PostureCheck, WhatTheJointCannotDoIsAWarning) {
  EXPECT_FALSE(Mentions(BuildCheck(WithPosture(2, 1.0)), Severity::kWarning, "arm 6: joint 2"));
  EXPECT_TRUE(Mentions(BuildCheck(WithPosture(3, 1.5)), Severity::kWarning,
                       "arm 6: joint 3 comes to its posture from the other side only while"));
  EXPECT_TRUE(Mentions(BuildCheck(WithPosture(3, 0.2)), Severity::kWarning,
                       "arm 6: joint 3 can be at its posture of 0.200 rad on"));
  ScenarioConfig near = WithPosture(3, 1.9);  // within 1.7 m, where 2.5 m of stretched links do not fit
  near.leader.axes = {{1.0, 0.1, 0.5, 0.0}, {1.1, 0.1, 0.5, M_PI / 2}};
  EXPECT_TRUE(Mentions(BuildCheck(near), Severity::kWarning, "it can neither stretch nor fold"));
}

TEST(PathCheck, TooLittleRoomBesideAnObstacleIsAWarning) {
  ScenarioConfig scenario = PaperScenario();
  PlanarArmConfig& arm = scenario.fleet.arms[5].arm;
  EXPECT_FALSE(Mentions(BuildCheck(scenario), Severity::kWarning, "arm 6: comes to"));
  arm.obstacle_count = 1;
  arm.obstacles[0] = {ObstacleKind::kDisc, 1.7, 1.3, 0.05, 0.0};  // on the leader's path
  EXPECT_TRUE(Mentions(BuildCheck(scenario), Severity::kWarning, "mm from an obstacle on the leader's path"));
  scenario.fleet.arms[5].control.subtask.avoidance.enabled = false;
  EXPECT_FALSE(Mentions(BuildCheck(scenario), Severity::kWarning, "mm from an obstacle"));
}

TEST(BusLoad, CountsWhatAJointAsksAnswersAndGetsEachTick) {
  const FleetConfig fleet = PaperScenario().fleet;
  // Request 55, answer 135, torque of 4 bytes 95 bits at 100 Hz; heartbeat of 135 at 10 Hz.
  constexpr double kJoint = (100.0 * (55 + 135 + 95) + 10.0 * 135) / 1e6;
  EXPECT_NEAR(ArmBusLoad(fleet.arms[0], {}, {}), 2 * kJoint, 2e-4 * kJoint);
  EXPECT_NEAR(ArmBusLoad(fleet.arms[5], {}, {}), 3 * kJoint, 3e-4 * kJoint);
  EmulatedDriveConfig cyclic;
  cyclic.feedback_period_s = 0.02;
  EXPECT_NEAR(ArmBusLoad(fleet.arms[5], {}, cyclic), 3 * (kJoint + 50 * 135 / 1e6), 1e-4);
}

TEST(BusLoad, IsInfiniteForDrivesThatDoNotComeUp) {
  EmulatedDriveConfig without_watchdog;
  without_watchdog.watchdog_s = 0.0;
  EXPECT_TRUE(std::isinf(ArmBusLoad(PaperScenario().fleet.arms[0], {}, without_watchdog)));
}

TEST(BusLoad, MoreThanABusCarriesIsAnError) {
  FleetConfig fleet = PaperScenario().fleet;
  fleet.timing.period_s = 0.0005;
  const CheckResult result = BuildCheck(fleet);
  EXPECT_TRUE(Mentions(result, Severity::kError, "arm 6: its bus"));
  EXPECT_FALSE(result.ok());
}

TEST(CheckResult, FleetAloneIsCheckedForWhatItSays) {
  const CheckResult result = BuildCheck(PaperScenario().fleet);
  EXPECT_TRUE(result.ok());
  EXPECT_FALSE(result.estimator.has_value());
  EXPECT_FALSE(result.arms[0].path.has_value());
}

TEST(CheckResult, LeaderlessScenarioHasNoPathAndNoBoundsToMeet) {
  ScenarioConfig scenario = PaperScenario();
  scenario.leader.kind = LeaderKind::kNone;
  scenario.fleet.estimator.leaderless = true;
  scenario.fleet.topologies = {{{{1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 6}, {6, 7}}, {}}};
  const CheckResult result = BuildCheck(scenario);
  EXPECT_TRUE(result.ok());
  EXPECT_FALSE(result.estimator.has_value());
  EXPECT_EQ(result.topologies[0].root_id, 1);
}

TEST(CheckOutput, TextFitsOnAPageAndItsTablesAreAligned) {
  std::ostringstream out;
  PrintText(BuildCheck(PaperScenario()), out);
  std::istringstream lines(out.str());
  std::vector<size_t> arm_rows;
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    EXPECT_LE(line.size(), 160u) << line;
    if (line.starts_with("    ") && line.size() > 5 && std::isdigit(line[4]) && line[5] == ' ')
      arm_rows.push_back(line.size());
  }
  EXPECT_LE(count, 60);
  ASSERT_EQ(arm_rows.size(), 7u);
  EXPECT_EQ(arm_rows, std::vector<size_t>(7, arm_rows[0]));
}

TEST(CheckOutput, JsonSaysTheSame) {
  const CheckResult result = BuildCheck(PaperScenario());
  std::ostringstream out;
  PrintJson(result, out);
  const auto json = nlohmann::json::parse(out.str());
  EXPECT_EQ(json["ok"], true);
  EXPECT_EQ(json["topologies"][0]["depth"]["6"], 2);
  EXPECT_EQ(json["topologies"][0]["single_cuts"][2]["cut_off"], (std::vector<int>{5, 6}));
  EXPECT_EQ(json["arms"].size(), 7u);
  EXPECT_EQ(json["arms"][4]["reach_outer_m"], result.arms[4].path->reach_outer_m);
  EXPECT_EQ(json["arms"][6]["K_r_suffices"], false);
  EXPECT_EQ(json["findings"].size(), result.findings.size());
}

TEST(CheckOutput, LeaderAtRestGivesNoRatioInJson) {
  ScenarioConfig scenario = PaperScenario();
  scenario.leader.axes = {{1.2, 0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}};
  std::ostringstream out;
  PrintJson(BuildCheck(scenario), out);
  EXPECT_TRUE(nlohmann::json::parse(out.str())["estimator"]["ratio"][0].is_null());
}

// Runs the command as a person would; what it writes is caught.
struct CommandRun {
  explicit CommandRun(const CheckOptions& options) {
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    exit_code = RunCheck(options);
    output = ::testing::internal::GetCapturedStdout();
    errors = ::testing::internal::GetCapturedStderr();
  }
  int exit_code;
  std::string output;
  std::string errors;
};

const std::string kScenarioFile = ARMADA_SOURCE_DIR "/hil/scenarios/paper.toml";
const std::string kFleetFile = ARMADA_SOURCE_DIR "/firmware/fleets/paper.toml";

TEST(CheckCommand, TellsAFleetFromAScenario) {
  const CommandRun fleet({kFleetFile, {}, false});
  EXPECT_EQ(fleet.exit_code, 0);
  EXPECT_NE(fleet.output.find("A1"), std::string::npos);
  EXPECT_EQ(fleet.output.find("A2"), std::string::npos);
  const CommandRun scenario({kScenarioFile, {}, false});
  EXPECT_EQ(scenario.exit_code, 0);
  EXPECT_NE(scenario.output.find("A2"), std::string::npos);
}

TEST(CheckCommand, BadConfigurationIsListedOnStandardErrorAlone) {
  const CommandRun run({kScenarioFile, {"estimator.beta_2_m_s2=5"}, true});
  EXPECT_EQ(run.exit_code, 78);
  EXPECT_TRUE(run.output.empty());
  EXPECT_NE(run.errors.find("beta_2_m_s2"), std::string::npos) << run.errors;
  EXPECT_EQ(CommandRun({"nowhere.toml", {}, false}).exit_code, 78);
}

TEST(CheckCommand, ImpossibleTaskExitsWithOne) {
  const CommandRun run(
      {kScenarioFile, {"criterion.error_max_m=0.0001"}, false});  // damping leaves arm 5 0.6 mm
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.output.find("error: arm 5: would miss the leader"), std::string::npos) << run.output;
}

}  // namespace
}  // namespace armada
