// Fleets, failures and leaders that are not the paper's, in short: docs/scenarios.md has the figures over
// many seeds.

#include <filesystem>
#include <fstream>

#include "hil/estimate_bound.h"
#include "host/fleet/generate_fleet.h"
#include "tests/closed_loop/simulate.h"

namespace armada {
namespace {

std::vector<std::string> Short(std::vector<std::string> sets = {}) {
  for (const char* set : {"seconds=10.0", "window_start_s=6.0"}) sets.emplace_back(set);
  return sets;
}

TEST(OtherFleets, OnARingALineAndATreeTrack) {
  EXPECT_TRUE(Simulate("ring", 1, Short()).ok);
  EXPECT_TRUE(Simulate("line", 1, Short()).ok);
  EXPECT_TRUE(
      Simulate("paper", 1, Short({std::string("fleet=") + ARMADA_SOURCE_DIR + "/firmware/fleets/tree.toml"}))
          .ok);
}

// What an estimate passed down costs shows where each arm is compared with itself next to the leader, from
// the same start under the same disturbance. Arms of one type at each depth would still differ by their
// disturbances.
TEST(OtherFleets, SixHopsDownALineAnArmIsAsGoodAsNextToTheLeader) {
  const std::string all_pinned = "graph=[{pins=[1,2,3,4,5,6,7]}]";
  const std::string backwards =
      "graph=[{pins=[7],edges=[{from=7,to=6},{from=6,to=5},{from=5,to=4},{from=4,to=3},{from=3,to=2},{from=2,"
      "to=1}]}]";
  const RunMetrics pinned = Simulate("line", 1, Short({all_pinned}));
  for (const RunMetrics& line : {Simulate("line", 1, Short()), Simulate("line", 1, Short({backwards}))}) {
    for (size_t i = 0; i < line.arms.size(); ++i) {
      EXPECT_LT(line.arms[i].rms_m, 1.3 * pinned.arms[i].rms_m) << "arm " << line.arms[i].id;
    }
  }
}

TEST(OtherFleets, ATwoWayRingDoesNotFeedErrorsBack) {
  std::string edges;
  for (int i = 1; i <= 7; ++i) {
    const std::string here = std::to_string(i);
    const std::string next = std::to_string(i % 7 + 1);
    for (const auto& [from, to] : {std::pair{here, next}, {next, here}})
      edges.append("{from=").append(from).append(",to=").append(to).append("},");
  }
  const RunMetrics metrics = Simulate("paper", 1, Short({"graph=[{pins=[1],edges=[" + edges + "]}]"}));
  EXPECT_TRUE(metrics.ok);
  EXPECT_LT(FleetEstimatorRms(metrics), 0.1e-3);
}

TEST(OtherFleets, FiftyArmsOnRandomDigraphsTrack) {
  for (const uint64_t seed : {1U, 2U, 3U}) {
    FleetPlan plan;
    plan.graph = GraphShape::kRandom;
    plan.like = std::string(ARMADA_SOURCE_DIR) + "/firmware/fleets/paper.toml";
    plan.name = "random";
    plan.arms = 50;
    plan.pins = 3;
    plan.vary = 0.1;
    plan.seed = seed;
    std::vector<ConfigError> errors;
    const auto text = GenerateFleet(plan, &errors);
    ASSERT_TRUE(text.has_value());
    const std::string path = testing::TempDir() + "armada_random_fleet.toml";
    std::ofstream(path) << *text;
    const RunMetrics metrics =
        Simulate("random_50", seed, Short({"fleet=" + path, "network.delay_ticks=1", "network.loss=0.1"}));
    std::filesystem::remove(path);
    EXPECT_EQ(metrics.arms.size(), 50u);
    EXPECT_TRUE(metrics.ok) << "seed " << seed;
  }
}

TEST(OtherFleets, StandADelayedAndLossyLink) {
  for (const char* scenario : {"line", "random_50"}) {
    EXPECT_TRUE(
        Simulate(scenario, 1, Short({"network.delay_ticks=2", "network.loss=0.3", "estimator.age_max_s=0.5"}))
            .ok)
        << scenario;
  }
}

const std::vector<std::string> kCutAtSix = {"network.lost.1.at_s=6.0", "seconds=10.0", "window_start_s=7.0"};

std::vector<std::string> CutAtSix(const std::vector<std::string>& more) {
  std::vector<std::string> sets = kCutAtSix;
  sets.insert(sets.end(), more.begin(), more.end());
  return sets;
}

TEST(LostLink, ArmsBehindItBrakeAndTheOthersGoOn) {
  const RunMetrics metrics = Simulate("tree_cut", 1, kCutAtSix);
  EXPECT_TRUE(metrics.ok);
  for (const ArmMetrics& arm : metrics.arms) {
    EXPECT_EQ(arm.standing, arm.id == 2 || arm.id == 4 || arm.id == 5);
    EXPECT_EQ(arm.state, arm.standing ? "HOLD" : "RUN");
    if (arm.standing) {
      EXPECT_EQ(arm.faults, std::vector<std::string>{"leader lost"});
      EXPECT_LT(arm.joint_speed_max_rad_s, 1.0) << "arm " << arm.id;
      EXPECT_LT(arm.estimator_max.v_m_s, 2.0) << "it stands still and does not fly away";
    } else {
      ASSERT_TRUE(arm.settled_s.has_value()) << "arm " << arm.id;
      EXPECT_LT(*arm.settled_s, 6.0) << "it did not notice";
    }
  }
}

TEST(LostLink, IsNoticedByTheCriterionUnlessItNamesTheArms) {
  EXPECT_FALSE(Simulate("tree_cut", 1, CutAtSix({"criterion.standing=[]"})).ok);
  EXPECT_FALSE(Simulate("tree_cut", 1, CutAtSix({"criterion.standing=[2,4,5,6]"})).ok) << "arm 6 moves on";
}

std::vector<std::string> Cut(const std::string& until_s) {
  return {"network.lost.1.at_s=6.0", "network.lost.1.until_s=" + until_s, "seconds=15.0",
          "window_start_s=13.0", "criterion.standing=[]"};
}

TEST(LostLink, ThatComesBackAtOnceIsNotNoticed) {
  EXPECT_TRUE(Simulate("tree_cut", 1, Cut("6.07")).ok);
}

TEST(LostLink, ThatComesBackLaterIsForAnOperatorToTrust) {
  const RunMetrics metrics = Simulate("tree_cut", 1, Cut("6.2"));
  EXPECT_FALSE(metrics.ok);
  for (const ArmMetrics& arm : metrics.arms) {
    const bool behind = arm.id == 2 || arm.id == 4 || arm.id == 5;
    EXPECT_EQ(arm.state, behind ? "HOLD" : "RUN") << "arm " << arm.id;
  }
}

TEST(LostLink, WithASpareOneIsNotNoticed) {
  const RunMetrics metrics = Simulate("tree_spare", 1, CutAtSix({"network.lost.1.until_s=8.0"}));
  EXPECT_TRUE(metrics.ok);
  for (const ArmMetrics& arm : metrics.arms) {
    ASSERT_TRUE(arm.settled_s.has_value()) << "arm " << arm.id;
    EXPECT_LT(*arm.settled_s, 6.0) << "arm " << arm.id;
  }
}

// The errors that come out are those that the bound says are possible: neither above it nor far below.
void ExpectErrorsAtTheirBound(const ScenarioConfig& scenario, double share) {
  const auto bounds = BoundEstimates(scenario);
  ASSERT_TRUE(bounds.has_value());
  const RunMetrics metrics = Simulation(scenario, 1).Run(nullptr);
  for (size_t i = 0; i < metrics.arms.size(); ++i) {
    const EstimatorMax& error = metrics.arms[i].estimator_max;
    const EstimateBound& bound = (*bounds)[i];
    for (const auto& [came_out, possible] :
         {std::pair{error.x_m, bound.x_m}, {error.v_m_s, bound.v_m_s}, {error.a_m_s2, bound.a_m_s2}}) {
      EXPECT_LE(came_out, possible * (1.0 + 1e-6)) << scenario.name << ", arm " << i + 1;
      EXPECT_GE(came_out, share * possible) << scenario.name << ", arm " << i + 1;
    }
  }
}

TEST(EstimateBounds, HoldAndAreNearlyAttained) {
  ExpectErrorsAtTheirBound(ScenarioNamed("jointly", {"seconds=16.0", "window_start_s=13.0"}), 0.9);
  // The leader's largest snap and a switch of topologies do not meet.
  ExpectErrorsAtTheirBound(ScenarioNamed("switching", {"seconds=16.0", "window_start_s=13.0"}), 0.5);
  ExpectErrorsAtTheirBound(ScenarioNamed("line", {"seconds=12.0", "window_start_s=8.0"}), 0.9);
  ExpectErrorsAtTheirBound(
      ScenarioNamed("ring", {"seconds=12.0", "window_start_s=8.0", "network.delay_ticks=1"}), 0.9);
  ExpectErrorsAtTheirBound(
      ScenarioNamed("paper", {"seconds=12.0", "window_start_s=8.0", "leader.rate_hz=30.0"}), 0.9);
}

TEST(JointlyConnected, TopologiesThatReachAllOnlyTogetherAreEnough) {
  const RunMetrics metrics = Simulate("jointly", 1, Short());
  EXPECT_TRUE(metrics.ok);
  EXPECT_LT(metrics.fleet_rms_m, 2e-3);
}

TEST(OtherLeaders, FastRoundCorneredAndStandingStillAreTracked) {
  for (const char* scenario : {"fast", "circle", "corners", "still"}) {
    const RunMetrics metrics = Simulate(scenario, 1, Short());
    EXPECT_TRUE(metrics.ok) << scenario;
    EXPECT_LT(metrics.fleet_rms_m, 1.3e-3) << scenario;
    for (const ArmMetrics& arm : metrics.arms) EXPECT_LE(arm.torque_max_Nm, arm.dof == 2 ? 150.0 : 300.0);
  }
}

}  // namespace
}  // namespace armada
