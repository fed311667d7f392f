#include "hil/start_state.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/core/paper_setting.h"

namespace armada {
namespace {

ScenarioConfig ScenarioOfPaperArms(StartKind kind) {
  ScenarioConfig scenario;
  for (int id = 1; id <= 7; ++id) {
    ArmEntry entry;
    entry.id = id;
    entry.arm = PaperArm(id);
    scenario.fleet.arms.push_back(entry);
  }
  scenario.leader.axes = {{1.2, 0.5, 0.5, 0.0}, {1.3, 0.3, 0.5, std::numbers::pi / 2.0}};
  scenario.start.kind = kind;
  return scenario;
}

std::vector<double> Numbers(const ArmStart& start) {
  std::vector<double> numbers(start.q_rad.begin(), start.q_rad.end());
  numbers.insert(numbers.end(), start.dq_rad_s.begin(), start.dq_rad_s.end());
  const Zeta& zeta = start.controller.zeta;
  for (const TaskVector* part : {&zeta.x_m, &zeta.v_m_s, &zeta.a_m_s2}) {
    numbers.insert(numbers.end(), part->begin(), part->end());
  }
  numbers.insert(numbers.end(), start.controller.theta_hat.begin(), start.controller.theta_hat.end());
  return numbers;
}

TEST(StartState, BoxFillsThePapersRanges) {
  const ScenarioConfig scenario = ScenarioOfPaperArms(StartKind::kBox);
  const LeaderPath leader(scenario.leader);
  double lowest = 0.0, highest = 0.0, theta_lowest = 5.0, theta_highest = 0.0;
  for (uint64_t seed = 0; seed < 200; ++seed) {
    for (size_t arm = 0; arm < 7; ++arm) {
      const ArmStart start = DrawStart(scenario, arm, seed, &leader);
      for (const double number : Numbers(start)) {
        lowest = std::min(lowest, number);
        highest = std::max(highest, number);
      }
      theta_lowest = std::min(theta_lowest, start.controller.theta_hat.minCoeff());
      theta_highest = std::max(theta_highest, start.controller.theta_hat.maxCoeff());
      EXPECT_EQ(start.controller.theta_hat.size(), PlanarArm(scenario.fleet.arms[arm].arm).parameter_count());
      const auto dof = static_cast<size_t>(scenario.fleet.arms[arm].arm.dof);
      for (size_t i = dof; i < kMaxDof; ++i) EXPECT_EQ(start.q_rad[i], 0.0);
    }
  }
  EXPECT_GE(lowest, -5.0);
  EXPECT_LT(lowest, -4.99);
  EXPECT_LT(highest, 5.0);
  EXPECT_GT(highest, 4.99);
  EXPECT_GE(theta_lowest, 0.0);
  EXPECT_LT(theta_lowest, 0.01);
  EXPECT_GT(theta_highest, 4.99);
}

TEST(StartState, SameSeedSameStart) {
  const ScenarioConfig scenario = ScenarioOfPaperArms(StartKind::kBox);
  const LeaderPath leader(scenario.leader);
  const std::vector<double> first = Numbers(DrawStart(scenario, 2, 11, &leader));
  EXPECT_EQ(first, Numbers(DrawStart(scenario, 2, 11, &leader)));
  EXPECT_NE(first, Numbers(DrawStart(scenario, 2, 12, &leader)));
  EXPECT_NE(first, Numbers(DrawStart(scenario, 3, 11, &leader)));
}

TEST(StartState, NearLeaderIsAtRestWithTheEndEffectorNearTheLeader) {
  const ScenarioConfig scenario = ScenarioOfPaperArms(StartKind::kNearLeader);
  const LeaderPath leader(scenario.leader);
  const TaskVector x_0 = leader.At(0.0).x_m;
  for (uint64_t seed = 0; seed < 50; ++seed) {
    for (size_t i = 0; i < 7; ++i) {
      const ArmStart start = DrawStart(scenario, i, seed, &leader);
      PlanarPlant plant(scenario.fleet.arms[i].arm);
      plant.q_rad = start.q_rad;
      const PlanarPlant::Tip tip = plant.EndEffector();
      for (size_t c = 0; c < 2; ++c) {
        EXPECT_NEAR(tip.x_m[c], x_0[static_cast<Eigen::Index>(c)], scenario.start.near_leader_m + 2e-3)
            << "arm " << i + 1 << ", seed " << seed;
      }
      for (const double dq : start.dq_rad_s) EXPECT_EQ(dq, 0.0);
    }
  }
}

TEST(ReachFrom, FindsThePointFromWhateverPosture) {
  const ScenarioConfig scenario = ScenarioOfPaperArms(StartKind::kBox);
  const LeaderPath leader(scenario.leader);
  for (uint64_t seed = 0; seed < 200; ++seed) {
    for (size_t i = 0; i < 7; ++i) {
      const PlanarArm arm(scenario.fleet.arms[i].arm);
      const ArmStart start = DrawStart(scenario, i, seed, &leader);
      const TaskVector x = leader.At(0.01 * static_cast<double>(seed)).x_m;
      const JointVector q = ReachFrom(arm, Eigen::Map<const JointVector>(start.q_rad.data(), arm.dof()), x);
      EXPECT_NEAR((arm.Position(arm.At(q)) - x).norm(), 0.0, 1e-6) << "arm " << i + 1 << ", seed " << seed;
      // Already there, it stays.
      EXPECT_LT((ReachFrom(arm, q, x) - q).norm(), 1e-6);
    }
  }
}

}  // namespace
}  // namespace armada
