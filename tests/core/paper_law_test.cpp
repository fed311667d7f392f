#include "firmware/core/paper_law.h"

#include <gtest/gtest.h>

#include <Eigen/QR>

#include "tests/core/paper_setting.h"
#include "tests/support/random_arms.h"

namespace armada {
namespace {

// One instant of an arm that follows a target: a random state with the end effector away from singularities.
struct Instant {
  PlanarArm arm;
  ControlConfig config;
  ParameterVector theta_hat;
  LawInput in;
};

Instant RandomInstant(RandomArms& random, int id) {
  PlanarArmConfig arm_config = PaperArm(id);
  arm_config.gravity_m_s2 = id % 2 == 0 ? 9.81 : 0.0;
  const PlanarArm arm(arm_config);
  Instant instant{arm, PaperController(arm_config).control, {}, {}};
  SubtaskConfig& subtask = instant.config.subtask;
  subtask.phi_max_rad_s = 0.0;
  if (id == 6) {
    subtask.kind = SubtaskKind::kPosture;
    subtask.joint = 2;
    subtask.goal_rad = 1.0;
    subtask.gain = 9.0;
  }
  if (id == 7) subtask.kind = SubtaskKind::kManipulability;
  instant.theta_hat = random.Numbers<ParameterVector>(arm.parameter_count(), 5.0);
  LawInput& in = instant.in;
  const Eigen::Index n = arm.dof();
  in.q_rad = random.Numbers(n, 3.0);
  in.q_rad[1] = random.In(0.8, 2.0);
  if (n == 3) in.q_rad[2] = random.In(-0.5, 0.5);
  in.dq_rad_s = random.Numbers(n, 2.0);
  in.zeta = {random.Numbers<TaskVector>(2, 2.0), random.Numbers<TaskVector>(2, 2.0),
             random.Numbers<TaskVector>(2, 5.0)};
  in.period_s = in.elapsed_s = 0.01;
  return instant;
}

// (1.5), with J# by a general decomposition.
JointVector ReferenceSpeed(const Instant& c, const JointVector& q, const Zeta& zeta) {
  const PlanarArm::Posture at = c.arm.At(q);
  const Eigen::MatrixXd J = c.arm.Jacobian(at);
  const Eigen::MatrixXd J_sharp = J.completeOrthogonalDecomposition().pseudoInverse();
  const JointVector phi = PrintedSubtaskVelocity(c.config.subtask, c.arm, q, at, c.arm.Jacobian(at));
  const Eigen::MatrixXd N = Eigen::MatrixXd::Identity(c.arm.dof(), c.arm.dof()) - J_sharp * J;
  const double alpha = c.config.paper.alpha_1_s;
  return J_sharp * (zeta.v_m_s - alpha * (c.arm.Position(at) - zeta.x_m)) + N * phi;
}

// What (1.2) needs, with (1.6) as the difference of (1.5) along the motion.
struct Expected {
  JointVector dq_r, ddq_r, s;
};
Expected Expect(const Instant& c) {
  constexpr double kStep_s = 1e-6;
  const LawInput& in = c.in;
  const JointVector dq_r = ReferenceSpeed(c, in.q_rad, in.zeta);
  const JointVector after = ReferenceSpeed(c, in.q_rad + kStep_s * in.dq_rad_s, Taylor(in.zeta, kStep_s));
  const JointVector before = ReferenceSpeed(c, in.q_rad - kStep_s * in.dq_rad_s, Taylor(in.zeta, -kStep_s));
  return {dq_r, (after - before) / (2.0 * kStep_s), in.dq_rad_s - dq_r};
}

TEST(PaperLaw, TorqueIs1_2) {
  RandomArms random(1);
  for (int trial = 0; trial < 350; ++trial) {
    const Instant c = RandomInstant(random, 1 + trial % 7);
    const Expected e = Expect(c);
    const PlanarArm::Posture at = c.arm.At(c.in.q_rad);
    const Eigen::MatrixXd J = c.arm.Jacobian(at);
    const Eigen::MatrixXd K_x = Eigen::Vector2d(c.config.gains.K_x_Ns_m).asDiagonal();
    const JointVector g = c.arm.Bias(at, JointVector::Zero(c.arm.dof()), c.theta_hat);
    const JointVector feedforward = c.arm.Inertia(at, c.theta_hat) * e.ddq_r +
                                    c.arm.Coriolis(at, c.in.dq_rad_s, c.theta_hat) * e.dq_r + g;
    const JointVector damping = J.transpose() * K_x * J * e.s + c.config.gains.K_s_Nms_rad[0] * e.s;
    const JointVector sliding = c.config.gains.K_r_Nm[0] * e.s.cwiseSign();
    const JointVector expected = feedforward - damping - sliding;

    PaperLaw law(c.config, c.arm, c.theta_hat);
    EXPECT_LT((law.Torque(c.in) - expected).norm(), 1e-6 * (1.0 + expected.norm()));
  }
}

TEST(PaperLaw, AdaptationIsAnEulerStepOf1_8) {
  RandomArms random(2);
  for (int trial = 0; trial < 70; ++trial) {
    const Instant c = RandomInstant(random, 1 + trial % 7);
    const Expected e = Expect(c);
    const RegressorMatrix Y = c.arm.Regressor(c.arm.At(c.in.q_rad), c.in.dq_rad_s, e.dq_r, e.ddq_r);
    const ParameterVector expected = c.theta_hat - 0.01 * 0.1 * Y.transpose() * e.s;
    PaperLaw law(c.config, c.arm, c.theta_hat);
    law.Torque(c.in);
    EXPECT_LT((law.theta_hat() - expected).norm(), 1e-6 * (1.0 + expected.norm()));
  }
}

TEST(PaperLaw, IsNotFiniteAtASingularity) {  // as printed: nothing is damped
  RandomArms random(3);
  Instant c = RandomInstant(random, 1);
  c.in.q_rad = JointVector::Zero(2);
  EXPECT_FALSE(PaperLaw(c.config, c.arm, c.theta_hat).Torque(c.in).allFinite());
}

}  // namespace
}  // namespace armada
