#include "hil/estimate_bound.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hil/leader_path.h"
#include "hil/scenario_file.h"

namespace armada {
namespace {

ScenarioConfig Paper() {
  std::vector<ConfigError> errors;
  const auto scenario = LoadScenario(ARMADA_SOURCE_DIR "/hil/scenarios/paper.toml", {}, &errors);
  EXPECT_TRUE(errors.empty());
  return scenario.value();
}

ScenarioConfig PaperOnALine() {
  ScenarioConfig scenario = Paper();
  scenario.fleet.topologies = {{{{1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 6}, {6, 7}}, {{1}}}};
  return scenario;
}

std::vector<EstimateBound> Bounds(const ScenarioConfig& scenario) {
  const auto bounds = BoundEstimates(scenario);
  EXPECT_TRUE(bounds.has_value());
  return bounds.value_or(std::vector<EstimateBound>(scenario.fleet.arms.size()));
}

// Of news `age_s` old, predicted by the jerk that the leader had.
void ExpectExtrapolation(const EstimateBound& bound, double snap_m_s4, double age_s) {
  EXPECT_NEAR(bound.x_m, snap_m_s4 * std::pow(age_s, 4) / 24.0, 1e-12);
  EXPECT_NEAR(bound.v_m_s, snap_m_s4 * std::pow(age_s, 3) / 6.0, 1e-11);
  EXPECT_NEAR(bound.a_m_s2, snap_m_s4 * std::pow(age_s, 2) / 2.0, 1e-10);
}

// Arm i is i + 1 hops from the leader.
void ExpectOneExtrapolationAlong(const ScenarioConfig& line, double hop_s) {
  const double snap = LeaderPath(line.leader).Bounds().snap_m_s4;
  const auto bounds = Bounds(line);
  for (size_t i = 0; i < bounds.size(); ++i)
    ExpectExtrapolation(bounds[i], snap, hop_s * static_cast<double>(i + 1));
}

TEST(EstimateBound, OnALineIsOneExtrapolationOverTheHops) {
  ExpectOneExtrapolationAlong(PaperOnALine(), 0.01);
}

TEST(EstimateBound, GrowsWithTheDelayOfEachHop) {
  ScenarioConfig scenario = PaperOnALine();
  scenario.network.delay_ticks = 3;
  scenario.fleet.estimator.age_max_s = 1.0;
  ExpectOneExtrapolationAlong(scenario, 0.04);
}

TEST(EstimateBound, OfADelayThatLooksLikeAnOffsetOfClocksIsTheLeadersWayMeanwhile) {
  ScenarioConfig scenario = Paper();
  scenario.network.delay_ticks = 2;
  const double seen_m = Bounds(scenario)[0].x_m;
  scenario.fleet.link.shared_clock = false;
  EXPECT_NEAR(Bounds(scenario)[0].x_m, seen_m + 0.02 * 0.5 * M_PI, 2e-3);
}

TEST(EstimateBound, OfAJerkThatJumpsIsFromOneExtremeToTheOther) {
  ScenarioConfig scenario = PaperOnALine();
  scenario.leader.kind = LeaderKind::kWaypoints;
  scenario.leader.waypoints_m = {{1.0, 1.0}, {1.4, 1.0}};
  const double jerk = LeaderPath(scenario.leader).Bounds().jerk_m_s3;
  const auto bounds = Bounds(scenario);
  for (size_t i = 0; i < bounds.size(); ++i) {
    EXPECT_NEAR(bounds[i].x_m, 2.0 * jerk * std::pow(0.01 * static_cast<double>(i + 1), 3) / 6.0, 1e-9);
  }
}

TEST(EstimateBound, IsZeroForALeaderAtRest) {
  ScenarioConfig scenario = PaperOnALine();
  scenario.leader.kind = LeaderKind::kWaypoints;
  scenario.leader.waypoints_m = {{1.0, 1.0}};
  for (const EstimateBound& bound : Bounds(scenario)) EXPECT_EQ(bound.x_m, 0.0);
}

TEST(EstimateBound, GrowsWithoutLimitWhereTheLeaderIsLost) {
  ScenarioConfig scenario = PaperOnALine();
  scenario.network.lost = {{.from = 3, .to = 4, .at_s = 16.0}};
  const auto bounds = Bounds(scenario);
  EXPECT_LT(bounds[2].x_m, 1e-4);
  for (size_t i = 3; i < bounds.size(); ++i) EXPECT_GT(bounds[i].x_m, 10.0);
  scenario.network.lost[0].until_s = 16.05;
  for (const EstimateBound& bound : Bounds(scenario)) EXPECT_LT(bound.x_m, 1e-3);
}

// With betas that the leader outruns nothing is promised.
TEST(EstimateBound, IsLargeWhereA2Fails) {
  ScenarioConfig scenario = Paper();
  scenario.fleet.estimator.beta_3_m_s3 = 10.0;
  EXPECT_GT(Bounds(scenario)[0].x_m, 1.0);
}

TEST(EstimateBound, IsNotGivenWhereItDoesNotApply) {
  ScenarioConfig scenario = Paper();
  scenario.network.loss = 0.01;
  EXPECT_FALSE(BoundEstimates(scenario).has_value());
  scenario = Paper();
  scenario.fleet.estimator.kind = EstimatorKind::kImplicit;
  EXPECT_FALSE(BoundEstimates(scenario).has_value());
}

}  // namespace
}  // namespace armada
