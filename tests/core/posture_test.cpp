// A posture arrives: where the self-motion of the arm admits its goal at all, the joint goes there.

#include <gtest/gtest.h>

#include "firmware/core/subtask.h"
#include "tests/core/closed_loop.h"
#include "tests/core/paper_setting.h"
#include "tests/core/self_motion.h"

namespace armada {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kLap_s = 2.0;

SubtaskConfig Posture(int joint, double goal_rad) {
  SubtaskConfig config;
  config.kind = SubtaskKind::kPosture;
  config.joint = joint;
  config.goal_rad = goal_rad;
  config.gain = 9.0;
  return config;
}

double ErrorOf(const SubtaskConfig& config, const PlanarArm& arm, const JointVector& q) {
  return PostureError(config, arm, q, arm.At(q));
}

TEST(PostureError, LeadsToAGoalThatTheSelfMotionReaches) {
  RandomArms random(1);
  int blocked = 0;
  int one_way = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const PlanarArm arm(random.Config(3));
    const JointVector q = random.Numbers(3, 8.0);
    if (SigmaMin(arm, q) < 0.05) continue;
    const SubtaskConfig config = Posture(1 + trial % 3, random.In(-4.0, 4.0));
    const SelfMotion motion = FollowSelfMotion(arm, q, config.joint - 1);
    const double led_to = q[config.joint - 1] + ErrorOf(config, arm, q);
    EXPECT_NEAR(std::remainder(led_to - config.goal_rad, kTurn), 0.0, 1e-9);
    if (!motion.ContainsModuloTurns(config.goal_rad)) {
      ++blocked;
      continue;
    }
    EXPECT_TRUE(motion.Contains(led_to))
        << "trial " << trial << ": " << led_to << " in " << motion.lowest_rad << " to " << motion.highest_rad;
    one_way += !motion.turns;
  }
  EXPECT_GT(blocked, 40);
  EXPECT_GT(one_way, 40);
}

TEST(PostureError, OfALimitedJointHasOneGoalOnly) {
  PlanarArmConfig limited = PaperArm(6);
  limited.q_max_rad = JointVector::Constant(3, 6.0);
  const JointVector q{{0.3, 5.0, 0.4}};
  EXPECT_DOUBLE_EQ(ErrorOf(Posture(2, 1.0), PlanarArm(limited), q), -4.0);
  EXPECT_NEAR(ErrorOf(Posture(2, 1.0), PlanarArm(PaperArm(6)), q), kTurn - 4.0, 1e-12);
}

TEST(PostureError, AsPrintedCountsWholeTurns) {
  SubtaskConfig config = Posture(2, 1.0);
  config.form = PostureForm::kPrinted;
  EXPECT_DOUBLE_EQ(ErrorOf(config, PlanarArm(PaperArm(6)), JointVector{{0.3, 5.0, 0.4}}), -4.0);
}

TEST(PostureDistance, IsThatFromTheNearestGoal) {
  SubtaskConfig config = Posture(2, 1.0);
  const JointVector q{{0.3, 1.1 - 2.0 * kTurn, 0.4}};
  EXPECT_NEAR(PostureDistance(config, PaperArm(6), q), 0.1, 1e-12);
  config.form = PostureForm::kPrinted;
  EXPECT_NEAR(PostureDistance(config, PaperArm(6), q), 2.0 * kTurn - 0.1, 1e-12);
}

TEST(ExactPosture, MovesTheJointItselfWhateverTheMaintaskDoes) {
  RandomArms random(2);
  int checked = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const PlanarArm arm(random.Config(3 + trial % 5));
    const JointVector q = random.Numbers(arm.dof(), 4.0);
    SubtaskConfig config = Posture(1 + trial % 3, 0.0);
    config.goal_rad = q[config.joint - 1] + random.In(-0.1, 0.1);
    config.phi_max_rad_s = 0.0;
    const PlanarArm::Posture at = arm.At(q);
    const JacobianMatrix J = arm.Jacobian(at);
    const InverseMatrix J_sharp = DampedPseudoinverse({}, J).J_sharp;
    const JointMatrix N = JointMatrix::Identity(arm.dof(), arm.dof()) - J_sharp * J;
    const int j = config.joint - 1;
    if (SigmaMin(arm, q) < 0.2 || N(j, j) < config.freedom_min) continue;
    const JointVector dq_main = J_sharp * random.Numbers<TaskVector>(2, 1.0);
    const JointVector phi = SubtaskVelocity(config, arm, {q, at, J, J_sharp, dq_main});
    const JointVector dq_r = dq_main + N * phi;
    EXPECT_NEAR(dq_r[j], config.gain * ErrorOf(config, arm, q), 1e-9);
    EXPECT_LT((J * (dq_r - dq_main)).norm(), 1e-9);
    ++checked;
  }
  EXPECT_GT(checked, 150);
}

TEST(ExactPosture, AsksForLessWhereTheMaintaskHoldsTheJoint) {
  // Tip, base and third joint in line: with the tip held the second joint is at its turning point.
  const PlanarArm arm(PaperArm(6));
  const double inner = std::atan2(1.1 * std::sin(2.0), 0.8 + 1.1 * std::cos(2.0));
  const JointVector q{{-inner, 2.0, inner - 2.0}};
  const PlanarArm::Posture at = arm.At(q);
  const JacobianMatrix J = arm.Jacobian(at);
  const InverseMatrix J_sharp = DampedPseudoinverse({}, J).J_sharp;
  const JointVector still = JointVector::Zero(3);
  EXPECT_LT(SubtaskVelocity(Posture(2, 1.0), arm, {q, at, J, J_sharp, still}).norm(), 1e-6);
}

/// The paper's arm 6 from a state of the start box, disturbed.
ClosedLoop FromTheBox(const SubtaskConfig& subtask, RandomArms& random) {
  ArmControllerConfig config = PaperController(PaperArm(6));
  config.control.subtask = subtask;
  const PlanarArm arm(config.arm);
  ParameterVector theta_hat = random.Numbers<ParameterVector>(arm.parameter_count(), 2.5);
  theta_hat.array() += 2.5;
  Zeta zeta{random.Numbers<TaskVector>(2, 5.0), random.Numbers<TaskVector>(2, 5.0),
            random.Numbers<TaskVector>(2, 5.0)};
  ClosedLoop loop(config, {zeta, theta_hat}, PaperLeader);
  loop.plant().q_rad = ToPlant(random.Numbers(3, 5.0));
  loop.plant().dq_rad_s = ToPlant(random.Numbers(3, 5.0));
  return loop;
}

/// One lap of the leader under control, disturbed: how far the joint is from its goal at most, and whether
/// the self-motion admits the goal at all its phases.
struct Lap {
  double worst_rad = 0.0;
  bool admitted = true;
};
Lap RunLap(ClosedLoop& loop, const SubtaskConfig& subtask, RandomArms& random) {
  Lap lap;
  const double end_s = loop.time_s() + kLap_s;
  for (int tick = 0; loop.time_s() < end_s - 1e-9; ++tick) {
    loop.set_disturbance(random.Numbers(3, 40.0));
    loop.Tick();
    const JointVector q = FromPlant(loop.plant(), loop.plant().q_rad);
    const PlanarArm& arm = loop.controller().arm();
    lap.worst_rad = std::max(lap.worst_rad, PostureDistance(subtask, arm.config(), q));
    if (tick % 20 > 0) continue;
    const SelfMotion motion = FollowSelfMotion(arm, q, subtask.joint - 1);
    lap.admitted = lap.admitted && motion.ContainsModuloTurns(subtask.goal_rad);
  }
  return lap;
}

void RunDisturbed(ClosedLoop& loop, double until_s, RandomArms& random) {
  while (loop.time_s() < until_s - 1e-9) {
    loop.set_disturbance(random.Numbers(3, 40.0));
    loop.Tick();
  }
}

TEST(PostureOfArm6, ArrivesFromEveryStartOfTheBox) {
  RandomArms random(6);
  const SubtaskConfig subtask = Posture(2, 1.0);
  for (int start = 0; start < 60; ++start) {
    ClosedLoop loop = FromTheBox(subtask, random);
    RunDisturbed(loop, 7.0, random);
    const Lap lap = RunLap(loop, subtask, random);
    EXPECT_TRUE(lap.admitted) << "start " << start;
    EXPECT_LT(lap.worst_rad, 0.02) << "start " << start;
  }
}

TEST(PostureOfArm6, ArrivesWhereverTheSelfMotionAdmitsItsGoalForTheWholeLap) {
  RandomArms random(7);
  int admitted = 0;
  int refused = 0;
  for (int start = 0; start < 80; ++start) {
    const SubtaskConfig subtask = Posture(1 + start % 3, random.In(-3.1, 3.1));
    ClosedLoop loop = FromTheBox(subtask, random);
    RunDisturbed(loop, 9.0, random);
    const Lap lap = RunLap(loop, subtask, random);
    (lap.admitted ? admitted : refused) += 1;
    EXPECT_EQ(lap.worst_rad < 0.03, lap.admitted)
        << "joint " << subtask.joint << " to " << subtask.goal_rad << ": " << lap.worst_rad << " rad, "
        << NameOf(loop.controller().state()) << " " << NameOf(loop.controller().supervisor().cause());
  }
  EXPECT_GT(admitted, 20);
  EXPECT_GT(refused, 20);
}

TEST(PostureOfArm6, AsPrintedDoesNot) {
  RandomArms random(6);
  SubtaskConfig subtask = Posture(2, 1.0);
  subtask.form = PostureForm::kPrinted;
  int arrived = 0;
  for (int start = 0; start < 10; ++start) {
    ClosedLoop loop = FromTheBox(subtask, random);
    RunDisturbed(loop, 7.0, random);
    arrived += RunLap(loop, subtask, random).worst_rad < 0.02;
  }
  EXPECT_EQ(arrived, 0);
}

}  // namespace
}  // namespace armada
