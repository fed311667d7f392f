#include "firmware/core/arm_controller.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>
#include <string>
#include <vector>

#include "tests/core/closed_loop.h"
#include "tests/core/paper_setting.h"
#include "tests/support/numbers.h"

namespace armada {
namespace {

ArmControllerConfig Config(int dof, LawKind law, RandomArms& random) {
  ArmControllerConfig config = PaperController(random.Config(dof, 9.81));
  config.control.law = law;
  return config;
}

ClosedLoop Loop(const ArmControllerConfig& config) {
  return ClosedLoop(config, {PaperLeader(0.0), PlanarArm(config.arm).Theta()}, PaperLeader);
}

TEST(ArmController, BothLawsRunOnArmsOfTwoToSevenJoints) {
  RandomArms random(1);
  for (const LawKind law : {LawKind::kPaper, LawKind::kRobust}) {
    for (int dof = 2; dof <= kMaxDof; ++dof) {
      const ArmControllerConfig config = Config(dof, law, random);
      ClosedLoop loop = Loop(config);
      loop.plant().q_rad = ToPlant(random.Numbers(dof, 1.0));
      EXPECT_EQ(loop.controller().status().state, ControllerState::kInit);
      for (int k = 0; k < 5; ++k) loop.Tick();
      EXPECT_EQ(loop.controller().status().state, ControllerState::kRun);
      EXPECT_EQ(loop.controller().status().tau_Nm.size(), dof);
      EXPECT_EQ(loop.controller().theta_hat().size(), loop.controller().arm().parameter_count());
    }
  }
}

// The law does not run yet, and what it would want of spare joints is nothing.
TEST(ArmController, LooksAtAnArmWhoseDrivesAreOff) {
  RandomArms random(3);
  for (const LawKind law : {LawKind::kPaper, LawKind::kRobust}) {
    for (int dof = 1; dof <= kMaxDof; ++dof) {
      const ArmControllerConfig config = Config(dof, law, random);
      ArmController controller(config, {PaperLeader(0.0), PlanarArm(config.arm).Theta()},
                               StartMode::kMonitor);
      ArmInput in = Loop(config).Sample();
      in.drives_enabled = false;
      in.q_rad = random.Numbers(dof, 1.0);
      in.dq_rad_s = JointVector::Zero(dof);
      for (int k = 0; k < 3; ++k) {
        in.tick_s = in.sample_s = 0.01 * k;
        EXPECT_EQ(controller.Step(in), JointVector(JointVector::Zero(dof)));
        EXPECT_TRUE(std::isfinite(controller.status().subtask_error_rad_s));
      }
      EXPECT_EQ(controller.status().state, ControllerState::kMonitor);
    }
  }
}

TEST(ArmController, NeverSendsMoreThanTheTorqueLimit) {
  RandomArms random(2);
  for (const LawKind law : {LawKind::kPaper, LawKind::kRobust}) {
    for (int dof = 1; dof <= kMaxDof; ++dof) {
      const ArmControllerConfig config = Config(dof, law, random);
      ArmController controller(config, {PaperLeader(0.0), PlanarArm(config.arm).Theta()},
                               StartMode::kRunning);
      ClosedLoop loop = Loop(config);
      for (int k = 0; k < 50; ++k) {
        ArmInput in = loop.Sample();
        in.tick_s = in.sample_s = 0.01 * k;
        in.q_rad = random.Numbers(dof, 10.0);  // no arm moves like this: the law must be cut down
        in.dq_rad_s = random.Numbers(dof, 100.0);
        const JointVector tau_Nm = controller.Step(in);
        ASSERT_TRUE(tau_Nm.allFinite());
        ASSERT_TRUE((tau_Nm.cwiseAbs().array() <= config.torque_limit_Nm.array()).all());
      }
    }
  }
}

TEST(ArmController, NonFiniteInputEndsInFaultWithZeroTorque) {
  RandomArms random(3);
  const auto bad_inputs = [](const ArmInput& good) {
    std::vector<ArmInput> inputs;
    for (const double bad : {kNan, kInfinity, -kInfinity, 1e300}) {
      inputs.insert(inputs.end(), 2, good);
      inputs[inputs.size() - 2].q_rad[good.q_rad.size() - 1] = bad;
      inputs.back().dq_rad_s[0] = bad;
    }
    return inputs;
  };
  for (const LawKind law : {LawKind::kPaper, LawKind::kRobust}) {
    for (const int dof : {2, 3, 7}) {
      const ArmControllerConfig config = Config(dof, law, random);
      ClosedLoop loop = Loop(config);
      loop.plant().q_rad = ToPlant(random.Numbers(dof, 1.0));
      for (int k = 0; k < 10; ++k) loop.Tick();
      ASSERT_EQ(loop.controller().status().state, ControllerState::kRun);
      for (const ArmInput& bad : bad_inputs(loop.Sample())) {
        ArmController controller = loop.controller();
        const JointVector tau_Nm = controller.Step(bad);
        ASSERT_TRUE(tau_Nm.allFinite());
        if (bad.q_rad.allFinite() && bad.dq_rad_s.allFinite())
          continue;  // absurd but a number: limited is enough
        EXPECT_TRUE(tau_Nm.isZero(0.0));
        EXPECT_EQ(controller.status().state, ControllerState::kFault);
        EXPECT_EQ(controller.supervisor().cause(), Cause::kFeedbackNonsense);
        ArmInput good = loop.Sample();
        good.tick_s += 0.01;
        good.sample_s += 0.01;
        EXPECT_TRUE(controller.Step(good).isZero(0.0));
        EXPECT_EQ(controller.status().state, ControllerState::kFault);
      }
    }
  }
}

// The joints are known: the arm brakes.
TEST(ArmController, NonFiniteNeighboursOrParametersEndInASafeStop) {
  const ArmControllerConfig config = PaperController(PaperArm(1));
  ClosedLoop loop = Loop(config);
  loop.plant().q_rad = {0.3, 1.2};
  loop.RunUntil(0.2);
  ArmInput in = loop.Sample();
  in.neighbours.list[0].zeta.x_m[0] = kNan;
  EXPECT_TRUE(loop.controller().Step(in).allFinite());
  EXPECT_EQ(loop.controller().state(), ControllerState::kSafeStop);
  EXPECT_EQ(loop.controller().supervisor().cause(), Cause::kNonFiniteTorque);
  for (int k = 0; k < 200; ++k) EXPECT_TRUE(loop.controller().Step(loop.Sample()).allFinite());
  EXPECT_EQ(loop.controller().state(), ControllerState::kFault);

  ArmController unknown(config, {PaperLeader(0.0), ParameterVector::Constant(3, kNan)}, StartMode::kRunning);
  in = Loop(config).Sample();
  EXPECT_TRUE(unknown.Step(in).isZero(0.0));
  EXPECT_EQ(unknown.state(), ControllerState::kFault) << "it has not started yet";
}

TEST(ArmController, EstimateIsValidOnePeriodAfterTheTick) {
  ClosedLoop loop = Loop(PaperController(PaperArm(4)));
  loop.plant().q_rad = {0.3, 1.2};
  loop.RunUntil(3.0);
  EXPECT_NEAR(loop.controller().zeta_time_s(), 3.0, 1e-9);
  EXPECT_LT((loop.controller().zeta().x_m - PaperLeader(3.0).x_m).norm(), 20e-6);
}

TEST(ArmController, EstimateCoastsOverMissedTicks) {
  ClosedLoop loop = Loop(PaperController(PaperArm(4)));
  loop.plant().q_rad = {0.3, 1.2};
  loop.RunUntil(3.0);
  for (int k = 0; k < 5; ++k) loop.Tick(/*missed=*/true);
  const double coasted_s = loop.time_s();
  loop.Tick();
  EXPECT_NEAR(loop.controller().zeta_time_s(), coasted_s + 0.01, 1e-9);
  EXPECT_LT((loop.controller().zeta().x_m - PaperLeader(coasted_s + 0.01).x_m).norm(), 1e-3);
  EXPECT_TRUE(loop.controller().estimator().synced());
}

TEST(ArmController, TracksThroughMissedTicks) {
  for (const double latency_s : {0.001, 0.009}) {
    ArmControllerConfig config = PaperController(PaperArm(1));
    config.timing.sample_to_torque_s = latency_s;
    ClosedLoop loop = Loop(config);
    loop.plant().q_rad = {0.3, 1.2};
    loop.RunUntil(6.0);
    loop.StartWindow();
    RandomArms random(4);
    while (loop.time_s() < 10.0) loop.Tick(random.In(0.0, 1.0) < 0.1);
    EXPECT_EQ(loop.controller().status().state, ControllerState::kRun);
    EXPECT_LT(loop.max_m(), 20e-3) << "latency " << latency_s;
    loop.RunUntil(11.0);
    loop.StartWindow();
    loop.RunUntil(12.0);
    EXPECT_LT(loop.rms_m(), 1e-3) << "latency " << latency_s;
  }
}

TEST(ArmController, ASampleAfterTheTickIsTakenForWhatItIs) {
  ArmControllerConfig config = PaperController(PaperArm(1));
  ClosedLoop loop = Loop(config);
  loop.plant().q_rad = {0.3, 1.2};
  loop.RunUntil(3.0);
  ArmInput in = loop.Sample();
  in.sample_s += 0.004;
  loop.controller().Step(in);
  EXPECT_LT((loop.controller().status().zeta.x_m - PaperLeader(3.004).x_m).norm(), 20e-6);
}

TEST(ArmController, StatusTellsWhatThePaperPlots) {
  ArmControllerConfig config = PaperController(PaperArm(6));
  config.control.subtask.kind = SubtaskKind::kPosture;
  config.control.subtask.joint = 2;
  config.control.subtask.goal_rad = 1.0;
  config.control.subtask.gain = 9.0;
  ClosedLoop loop = Loop(config);
  loop.plant().q_rad = {0.3, 1.2, 0.5};
  loop.RunUntil(6.0);
  const ArmInput in = loop.Sample();
  const JointVector tau_Nm = loop.controller().Step(in);
  const ArmStatus& status = loop.controller().status();
  const PlanarArm& arm = loop.controller().arm();
  const JacobianMatrix J = arm.Jacobian(arm.At(in.q_rad));
  EXPECT_EQ(status.tau_Nm, tau_Nm);
  EXPECT_EQ(status.x_m, arm.Position(arm.At(in.q_rad)));
  EXPECT_DOUBLE_EQ(status.error_m, (status.x_m - status.zeta.x_m).norm());
  EXPECT_NEAR(status.manipulability, Eigen::Matrix2d(J * J.transpose()).determinant(), 1e-9);
  EXPECT_LT(status.subtask_error_rad_s, 0.1);  // (I - J#J)(dq - phi) is driven to zero
  EXPECT_NEAR(in.q_rad[1], 1.0, 1e-3);
}

TEST(ArmController, StatesHaveNames) {
  const std::vector<std::string> names = {"INIT",     "MONITOR", "ARMING",    "RUN",
                                          "DEGRADED", "HOLD",    "SAFE_STOP", "FAULT"};
  for (int i = 0; i < kControllerStates; ++i)
    EXPECT_EQ(NameOf(static_cast<ControllerState>(i)), names[static_cast<size_t>(i)]);
}

}  // namespace
}  // namespace armada
