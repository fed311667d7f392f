#include "firmware/core/subtask.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/core/paper_setting.h"
#include "tests/support/random_arms.h"

namespace armada {
namespace {

double Manipulability(const PlanarArm& arm, const JointVector& q) {
  const JacobianMatrix J = arm.Jacobian(arm.At(q));
  return Eigen::Matrix2d(J * J.transpose()).determinant();
}

JointVector Phi(const SubtaskConfig& config, const PlanarArm& arm, const JointVector& q) {
  const PlanarArm::Posture at = arm.At(q);
  return PrintedSubtaskVelocity(config, arm, q, at, arm.Jacobian(at));
}

JointVector Gradient(const PlanarArm& arm, const JointVector& q) {
  const PlanarArm::Posture at = arm.At(q);
  return ManipulabilityGradient(arm, at, arm.Jacobian(at));
}

TEST(Subtask, ManipulabilityGradientIsTheDerivative) {
  RandomArms random(1);
  for (int dof = 2; dof <= kMaxDof; ++dof) {
    for (int trial = 0; trial < 10; ++trial) {
      const PlanarArm arm(random.Config(dof));
      const JointVector q = random.Numbers(dof, 5.0);
      const JointVector gradient = Gradient(arm, q);
      for (int i = 0; i < dof; ++i) {
        const JointVector step = 1e-5 * JointVector::Unit(dof, i);
        const double slope = (Manipulability(arm, q + step) - Manipulability(arm, q - step)) / 2e-5;
        EXPECT_NEAR(gradient[i], slope, 1e-6 * (1.0 + gradient.norm()));
      }
    }
  }
}

TEST(Subtask, ManipulabilityGradientIsFiniteAtASingularity) {
  const PlanarArm arm(PaperArm(7));
  EXPECT_TRUE(Gradient(arm, JointVector::Zero(3)).isZero(1e-12));  // stretched: a minimum
}

TEST(Subtask, FollowingTheGradientRaisesManipulability) {
  const PlanarArm arm(PaperArm(7));
  SubtaskConfig config;
  config.kind = SubtaskKind::kManipulability;
  JointVector q{{0.2, 0.3, -0.2}};
  double before = Manipulability(arm, q);
  for (int step = 0; step < 50; ++step) {
    q += 1e-3 * Phi(config, arm, q);
    const double after = Manipulability(arm, q);
    EXPECT_GT(after, before);
    before = after;
  }
}

TEST(Subtask, PostureIsThePapersForArm6) {  // phi_6 = [0, 9 (1 - q_2), 0]
  const PlanarArm arm(PaperArm(6));
  SubtaskConfig config;
  config.kind = SubtaskKind::kPosture;
  config.joint = 2;
  config.goal_rad = 1.0;
  config.gain = 9.0;
  const JointVector q{{0.4, 0.8, -2.0}};
  EXPECT_LT((Phi(config, arm, q) - JointVector{{0.0, 9.0 * 0.2, 0.0}}).norm(), 1e-12);
}

TEST(Subtask, NoneWantsNoMotion) {
  RandomArms random(2);
  const PlanarArm arm(PaperArm(6));
  EXPECT_TRUE(Phi(SubtaskConfig{}, arm, random.Numbers(3, 5.0)).isZero());
}

TEST(Subtask, PhiIsScaledToItsBoundAndKeepsItsDirection) {
  RandomArms random(3);
  SubtaskConfig config;
  config.kind = SubtaskKind::kManipulability;
  config.gain = 20.0;
  SubtaskConfig unbounded = config;
  unbounded.phi_max_rad_s = 0.0;
  int bounded = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const PlanarArm arm(random.Config(3 + trial % 5));
    const JointVector q = random.Numbers(arm.dof(), 5.0);
    const JointVector phi = Phi(config, arm, q);
    const JointVector wanted = Phi(unbounded, arm, q);
    const double largest = wanted.cwiseAbs().maxCoeff();
    EXPECT_LE(phi.cwiseAbs().maxCoeff(), 3.0 * (1.0 + 1e-12));
    EXPECT_LT((phi - wanted * std::min(1.0, 3.0 / largest)).norm(), 1e-9);
    bounded += largest > 3.0;
  }
  EXPECT_GT(bounded, 20);
}

}  // namespace
}  // namespace armada
