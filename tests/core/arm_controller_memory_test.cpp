// Step makes no heap allocation, whatever is configured.
#include <gtest/gtest.h>

#include "firmware/core/arm_controller.h"
#include "tests/core/paper_setting.h"
#include "tests/support/limit_malloc.h"
#include "tests/support/random_arms.h"

namespace armada {
namespace {

void ExpectNoAllocation(const ArmControllerConfig& config, RandomArms& random) {
  const PlanarArm arm(config.arm);
  ArmController controller(config, {PaperLeader(0.0), arm.Theta()}, StartMode::kRunning);
  ArmInput in;
  in.neighbours.count = 3;
  JointVector q = random.Numbers(arm.dof(), 1.0);
  for (int k = 0; k < 20; ++k) {
    if (k == 10) q.setZero();                 // stretched: singular
    in.tick_s = 0.01 * (k < 15 ? k : k + 3);  // missed ticks
    in.sample_s = in.tick_s + 0.001;
    in.q_rad = q;
    in.dq_rad_s = random.Numbers(arm.dof(), 0.5);
    for (size_t j = 0; j < 3; ++j) {
      in.neighbours.list[j] = {1.0, PaperLeader(in.tick_s), 0.002, Estimator::kMaxAgreement, true};
    }
    const LimitMalloc guard;
    controller.Step(in);
  }
  in.q_rad[0] = std::numeric_limits<double>::quiet_NaN();
  const LimitMalloc guard;
  controller.Step(in);
}

TEST(ArmControllerMemory, StepAllocatesNothing) {
  RandomArms random(1);
  for (int dof = 1; dof <= kMaxDof; ++dof) {
    for (const double gravity_m_s2 : {0.0, 9.81}) {
      ArmControllerConfig config = PaperController(random.Config(dof, gravity_m_s2));
      config.control.adaptation.kind = AdaptationKind::kBoth;
      for (const LawKind law : {LawKind::kPaper, LawKind::kRobust}) {
        for (const EstimatorKind kind :
             {EstimatorKind::kPaper, EstimatorKind::kImplicit, EstimatorKind::kPredictive}) {
          for (const SubtaskKind subtask :
               {SubtaskKind::kNone, SubtaskKind::kPosture, SubtaskKind::kManipulability}) {
            config.control.law = law;
            config.control.subtask.kind = subtask;
            config.estimator.kind = kind;
            ExpectNoAllocation(config, random);
          }
        }
      }
    }
  }
}

TEST(ArmControllerMemory, StepAmongObstaclesAllocatesNothing) {
  RandomArms random(2);
  for (int dof = 3; dof <= kMaxDof; ++dof) {
    ArmControllerConfig config = PaperController(random.Config(dof));
    config.arm.q_min_rad = JointVector::Constant(dof, -0.5);
    config.arm.q_max_rad = JointVector::Constant(dof, 0.5);
    config.arm.obstacle_count = kMaxObstacles;
    for (ObstacleConfig& obstacle : config.arm.obstacles) obstacle.x_m = random.In(-2.0, 2.0);
    config.control.subtask.kind = SubtaskKind::kPosture;
    ExpectNoAllocation(config, random);
  }
}

TEST(ArmControllerMemory, TheCounterSeesAllocations) {
  if (!HeapCounter::available()) GTEST_SKIP() << "sanitizers own malloc";
  const uint64_t before = HeapCounter::Allocations();
  const std::vector<double> heap(100, 1.0);
  EXPECT_GT(HeapCounter::Allocations(), before) << heap.size();
}

}  // namespace
}  // namespace armada
