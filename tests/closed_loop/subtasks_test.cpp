// What spare joints do through the whole path, with sampling, latency and disturbance.

#include "tests/closed_loop/simulate.h"

namespace armada {
namespace {

const ArmMetrics& ArmOf(const RunMetrics& metrics, int id) {
  for (const ArmMetrics& arm : metrics.arms) {
    if (arm.id == id) return arm;
  }
  ADD_FAILURE() << "no arm " << id;
  return metrics.arms.front();
}

// Seeds 6, 9 and 28 are of those that the printed form leaves a whole turn away.
TEST(PaperScenario, Arm6GoesToItsPostureAndStaysThere) {
  for (const uint64_t seed : {1U, 6U, 9U, 28U}) {
    const RunMetrics metrics = Simulate("paper", seed, {"seconds=12.0", "window_start_s=8.0"});
    const ArmMetrics& arm = ArmOf(metrics, 6);
    ASSERT_TRUE(arm.posture.has_value());
    EXPECT_LT(arm.posture->max_rad, 0.02) << "seed " << seed;
    EXPECT_LT(arm.rms_m, 1.1e-3) << "seed " << seed;
  }
}

TEST(PaperScenario, Arm6WithTheFormAsPrintedIsCarriedOffOrATurnAway) {
  const std::vector<std::string> printed = {"seconds=12.0", "window_start_s=8.0",
                                            "arm.6.control.subtask.form=printed"};
  EXPECT_GT(ArmOf(Simulate("paper", 1, printed), 6).posture->max_rad, 0.04);
  EXPECT_GT(ArmOf(Simulate("paper", 9, printed), 6).posture->max_rad, 2.0);
}

TEST(PaperScenario, Arm7RaisesItsManipulability) {
  const RunMetrics metrics = Simulate("paper", 1, {"seconds=12.0", "window_start_s=8.0"});
  EXPECT_LT(*ArmOf(metrics, 7).subtask_rms_rad_s, 0.2);
  EXPECT_FALSE(ArmOf(metrics, 1).subtask_rms_rad_s.has_value());
}

TEST(ObstaclesScenario, LinksKeepClearAndJointsWithinLimits) {
  for (const uint64_t seed : {1U, 2U, 3U}) {
    const RunMetrics metrics = Simulate("obstacles", seed);
    EXPECT_TRUE(metrics.ok) << "seed " << seed;
    EXPECT_LT(metrics.fleet_rms_m, 1.1e-3) << "seed " << seed;
    for (const int id : {1, 3}) EXPECT_GT(ArmOf(metrics, id).clearance->min_m, 0.043) << "arm " << id;
    EXPECT_GT(ArmOf(metrics, 2).limits->margin_min_rad, 0.043);
  }
}

TEST(ObstaclesScenario, WithoutAvoidanceTheSameArmsRunIntoThem) {
  const std::string off = "arm.*.control.subtask.avoidance.enabled=false";
  const RunMetrics stopped = Simulate("obstacles", 1, {off});
  EXPECT_EQ(ArmOf(stopped, 2).faults, std::vector<std::string>{"joint limit crossed"});

  const RunMetrics metrics =
      Simulate("obstacles", 1, {off, "arm.*.control.supervisor.joint_limit_margin_rad=10"});
  EXPECT_TRUE(metrics.ok) << "the maintask does not know";
  for (const int id : {1, 3}) EXPECT_LT(ArmOf(metrics, id).clearance->min_m, -0.1) << "arm " << id;
  EXPECT_LT(ArmOf(metrics, 2).limits->margin_min_rad, -0.1);
}

}  // namespace
}  // namespace armada
