#include "firmware/core/reference.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "firmware/core/governor.h"
#include "tests/core/paper_setting.h"
#include "tests/support/random_arms.h"

namespace armada {
namespace {

const ReferenceConfig kReference;
const PseudoinverseConfig kPseudoinverse;

TEST(Approach, IsLinearThenBrakingThenConstant) {
  const double linear_until_m = kApproach.braking_m_s2 / (kApproach.alpha_1_s * kApproach.alpha_1_s);
  EXPECT_DOUBLE_EQ(kApproach.Speed(0.0), 0.0);
  EXPECT_DOUBLE_EQ(kApproach.Speed(0.5 * linear_until_m), kApproach.alpha_1_s * 0.5 * linear_until_m);
  EXPECT_DOUBLE_EQ(kApproach.Speed(0.1),
                   std::sqrt(2.0 * kApproach.braking_m_s2 * (0.1 - 0.5 * linear_until_m)));
  EXPECT_DOUBLE_EQ(kApproach.Speed(3.0), kApproach.speed_m_s);
}

// Following the profile, dv/dt = -v dv/de: never above the braking allowed, so the speed can be held to.
TEST(Approach, IsContinuousMonotoneAndNeverBrakesHarderThanAllowed) {
  constexpr double kStep_m = 1e-6;
  double before = 0.0;
  for (double error_m = 0.0; error_m < 0.6; error_m += kStep_m) {
    const double speed = kApproach.Speed(error_m);
    ASSERT_GE(speed, before);
    ASSERT_LE(speed - before, 1.01 * kApproach.alpha_1_s * kStep_m);
    ASSERT_LE(before * (speed - before) / kStep_m, kApproach.braking_m_s2 * (1.0 + 1e-6));
    ASSERT_LE(speed, kApproach.speed_m_s);
    before = speed;
  }
  EXPECT_EQ(before, kApproach.speed_m_s);
}

TEST(Approach, ImplicitSpeedIsThatOfTheDistanceLeft) {
  RandomArms random(8);
  for (int trial = 0; trial < 1000; ++trial) {
    const Approach approach{.alpha_1_s = random.In(1.0, 1000.0),
                            .braking_m_s2 = random.In(0.5, 50.0),
                            .speed_m_s = random.In(0.1, 5.0)};
    const double step_s = random.In(0.0, 0.02);
    const double error_m = std::pow(10.0, random.In(-6.0, 0.5));
    const double speed = approach.Speed(error_m, step_s);
    const double left_m = error_m - step_s * speed;
    ASSERT_GE(left_m, -1e-12);  // for any alpha: never past the target
    // At the bound of speed the distance left may have a higher speed of its own.
    EXPECT_NEAR(speed, approach.Speed(left_m), speed < approach.speed_m_s ? 1e-9 * (1.0 + speed) : 1e9);
  }
}

TEST(ClampToReach, LeavesReachablePointsAndMovesOthersAlongTheirRadius) {
  RandomArms random(1);
  for (int trial = 0; trial < 500; ++trial) {
    const PlanarArm arm(random.Config(1 + trial % kMaxDof));
    const double inner = arm.reach_min_m() + kReference.reach_inner_margin_m;
    const double outer = arm.reach_max_m() - kReference.reach_outer_margin_m;
    if (inner >= outer) continue;  // one link: a circle
    const TaskVector radius = random.Numbers<TaskVector>(2, 1.5 * arm.reach_max_m());
    const TaskVector x = arm.Base() + radius;
    const TaskVector clamped = ClampToReach(kReference, arm, x);
    const double r = radius.norm();
    const double expected = std::clamp(r, inner, outer);
    EXPECT_LT((clamped - (arm.Base() + radius * (expected / r))).norm(), 1e-12);
    EXPECT_TRUE(clamped == x || r != expected);
  }
}

TEST(ClampToReach, IsFiniteAtTheCentre) {
  const PlanarArm arm(PaperArm(1));
  EXPECT_TRUE(ClampToReach(kReference, arm, arm.Base()).allFinite());
}

JointVector ReferenceOf(const PlanarArm& arm, const JointVector& q, const Zeta& zeta,
                        const SubtaskConfig& subtask = {}, const ReferenceConfig& config = kReference) {
  return ReferenceVelocity(config, kApproach, kPseudoinverse, subtask, arm, q, zeta, true);
}

// An estimate the arm can follow: near its end effector, moving slowly.
Zeta NearbyTarget(const PlanarArm& arm, const JointVector& q, RandomArms& random) {
  return {arm.Position(arm.At(q)) + random.Numbers<TaskVector>(2, 0.05), random.Numbers<TaskVector>(2, 0.3),
          random.Numbers<TaskVector>(2, 1.0)};
}

TEST(ReferenceVelocity, MovesTheEndEffectorAsWantedAwayFromSingularities) {  // (1.5)
  RandomArms random(2);
  SubtaskConfig subtask;
  subtask.kind = SubtaskKind::kManipulability;
  int checked = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const PlanarArm arm(PaperArm(1 + trial % 7));
    const JointVector q = random.Numbers(arm.dof(), 3.0);
    const Zeta zeta = NearbyTarget(arm, q, random);
    const JointVector dq_r = ReferenceOf(arm, q, zeta, subtask);
    if (SigmaMin(arm, q) < 0.3 || dq_r.cwiseAbs().maxCoeff() >= kReference.joint_speed_rad_s) continue;
    if ((arm.Position(arm.At(q)) - arm.Base()).norm() > arm.reach_max_m() - 0.1) continue;
    if ((arm.Position(arm.At(q)) - arm.Base()).norm() < arm.reach_min_m() + 0.1) continue;
    const TaskVector e = zeta.x_m - arm.Position(arm.At(q));
    const TaskVector wanted = zeta.v_m_s + e.normalized() * kApproach.Speed(e.norm());
    EXPECT_LT((arm.Jacobian(arm.At(q)) * dq_r - wanted).norm(), 1e-9);
    ++checked;
  }
  EXPECT_GT(checked, 300);
}

// (1.5) at q+ = q + h (dq + dq_r) / 2, to second order in the way of a tick: the pull is that of the error
// left.
TEST(ReferenceVelocity, ImplicitFormIsStableForAnyAlpha) {
  const PlanarArm arm(PaperArm(4));
  const JointVector q{{0.3, 1.2}};
  Zeta zeta{arm.Position(arm.At(q)) + TaskVector{{1e-3, -2e-3}}, TaskVector::Zero(2), TaskVector::Zero(2)};
  for (const double alpha_1_s : {10.0, 100.0, 1e3, 1e4}) {
    const Approach approach{.alpha_1_s = alpha_1_s, .braking_m_s2 = 1e6, .speed_m_s = 1e3};
    constexpr double kHalf_s = 0.005;
    JointVector dq_r = JointVector::Zero(2);
    for (int iteration = 0; iteration < 10; ++iteration) {
      dq_r = ReferenceVelocity(kReference, approach, kPseudoinverse, {}, arm, q + kHalf_s * dq_r, dq_r,
                               kHalf_s, zeta, true);
    }
    const JointVector q_end = q + kHalf_s * dq_r;
    const TaskVector e_end = zeta.x_m - arm.Position(arm.At(q_end));
    const TaskVector pull = arm.Jacobian(arm.At(q_end)) * dq_r;
    EXPECT_LT((pull - alpha_1_s * e_end).norm(), 1e-3 * pull.norm()) << alpha_1_s;
  }
}

TEST(ReferenceVelocity, SubtaskMovesTheSpareJointsOnly) {
  RandomArms random(3);
  SubtaskConfig subtask;
  subtask.kind = SubtaskKind::kPosture;
  subtask.joint = 2;
  subtask.goal_rad = 1.0;
  const PlanarArm arm(PaperArm(6));
  const JointVector q{{0.3, 0.9, 0.8}};
  const Zeta zeta = NearbyTarget(arm, q, random);
  const JointVector change = ReferenceOf(arm, q, zeta, subtask) - ReferenceOf(arm, q, zeta);
  EXPECT_GT(change.norm(), 1e-3);
  EXPECT_LT((arm.Jacobian(arm.At(q)) * change).norm(), 1e-10);
}

TEST(ReferenceVelocity, IsScaledToTheJointSpeed) {
  RandomArms random(4);
  int scaled = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const PlanarArm arm(PaperArm(1 + trial % 7));
    const JointVector q = random.Numbers(arm.dof(), 3.0);
    const Zeta far{random.Numbers<TaskVector>(2, 5.0), random.Numbers<TaskVector>(2, 5.0),
                   random.Numbers<TaskVector>(2, 5.0)};
    ReferenceConfig free = kReference;
    free.joint_speed_rad_s = 1e9;
    const JointVector dq_r = ReferenceOf(arm, q, far);
    const JointVector wanted = ReferenceOf(arm, q, far, {}, free);
    EXPECT_LE(dq_r.cwiseAbs().maxCoeff(), kReference.joint_speed_rad_s * (1.0 + 1e-12));
    EXPECT_LT((dq_r.normalized() - wanted.normalized()).norm(), 1e-9);
    scaled += wanted.cwiseAbs().maxCoeff() > kReference.joint_speed_rad_s;
  }
  EXPECT_GT(scaled, 50);
}

TEST(ReferenceVelocity, IsFiniteAtSingularitiesAndOnTheTarget) {
  const PlanarArm arm(PaperArm(1));
  const JointVector stretched = JointVector::Zero(2);
  Zeta zeta = Zeta::Zero(2);
  EXPECT_TRUE(ReferenceOf(arm, stretched, zeta).allFinite());
  zeta.x_m = ClampToReach(kReference, arm, arm.Position(arm.At(stretched)));
  EXPECT_TRUE(ReferenceOf(arm, stretched, zeta).allFinite());
  const JointVector q{{0.3, 1.0}};
  zeta.x_m = arm.Position(arm.At(q));
  EXPECT_TRUE(ReferenceOf(arm, q, zeta).isZero(0.0));
}

TEST(ReferenceVelocity, IsZeroUntilSynced) {
  RandomArms random(5);
  const PlanarArm arm(PaperArm(3));
  const JointVector q = random.Numbers(2, 3.0);
  EXPECT_TRUE(ReferenceVelocity(kReference, kApproach, kPseudoinverse, {}, arm, q,
                                NearbyTarget(arm, q, random), false)
                  .isZero(0.0));
}

// M = f(J J'), f(x) = 1 / (x + l^2(x)), and its derivative along dG: by divided differences in the eigenbasis
// (Daleckii and Krein), which shares nothing with the code under test.
struct MatrixFunction {
  Eigen::Matrix2d M, dM;
};
MatrixFunction DampedInverse(const Eigen::Matrix2d& G, const Eigen::Matrix2d& dG) {
  const double threshold = kPseudoinverse.sigma_threshold_m * kPseudoinverse.sigma_threshold_m;
  const double l_max = kPseudoinverse.damping_max_m * kPseudoinverse.damping_max_m;
  const auto denominator = [&](double x) {
    return x + (x < threshold ? l_max * (1.0 - x / threshold) : 0.0);
  };
  const auto slope = [&](double x) {
    return -(1.0 - (x < threshold ? l_max / threshold : 0.0)) / (denominator(x) * denominator(x));
  };
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(G);
  const Eigen::Matrix2d& U = eigen.eigenvectors();
  const Eigen::Vector2d& x = eigen.eigenvalues();
  const Eigen::Vector2d f(1.0 / denominator(x[0]), 1.0 / denominator(x[1]));
  Eigen::Matrix2d weights;
  const double across = (f[1] - f[0]) / (x[1] - x[0]);
  weights << slope(x[0]), across, across, slope(x[1]);
  const Eigen::Matrix2d dG_in_basis = U.transpose() * dG * U;
  return {U * f.asDiagonal() * U.transpose(), U * weights.cwiseProduct(dG_in_basis) * U.transpose()};
}

// (1.6) with the damped J#: dJ#/dt = dJ'M + J'dM.
JointVector AnalyticAcceleration(const PlanarArm& arm, const JointVector& q, const JointVector& dq,
                                 const Zeta& zeta, const SubtaskConfig& subtask) {
  const PlanarArm::Posture at = arm.At(q);
  const Eigen::MatrixXd J = arm.Jacobian(at);
  const Eigen::MatrixXd dJ = arm.JacobianRate(at, dq);
  const auto [M, dM] = DampedInverse(J * J.transpose(), dJ * J.transpose() + J * dJ.transpose());
  const Eigen::MatrixXd J_sharp = J.transpose() * M;
  const Eigen::MatrixXd dJ_sharp = dJ.transpose() * M + J.transpose() * dM;
  const double alpha = kApproach.alpha_1_s;
  const TaskVector r = zeta.v_m_s - alpha * (arm.Position(at) - zeta.x_m);
  const TaskVector dr = zeta.a_m_s2 - alpha * (J * dq - zeta.v_m_s);
  const auto phi_at = [&](const JointVector& position) {
    const PlanarArm::Posture posture = arm.At(position);
    return PrintedSubtaskVelocity(subtask, arm, position, posture, arm.Jacobian(posture));
  };
  JointVector motion = J_sharp * dr + dJ_sharp * r;
  if (arm.dof() == PlanarArm::kTaskDim) return motion;
  const JointVector phi = phi_at(q);
  const JointVector dphi = (phi_at(q + 1e-6 * dq) - phi_at(q - 1e-6 * dq)) / 2e-6;
  return motion + dphi - J_sharp * (J * dphi) - dJ_sharp * (J * phi) - J_sharp * (dJ * phi);
}

class ExactDifference : public testing::Test {
 protected:
  // The governor's difference over [0, h] along q + t dq and the estimate's motion.
  static JointVector Difference(const PlanarArm& arm, const JointVector& q, const JointVector& dq,
                                const Zeta& zeta, const SubtaskConfig& subtask, double h_s) {
    Governor governor({.acceleration_rad_s2 = 1e9, .speed_rad_s = 1e9}, ReferenceOf(arm, q, zeta, subtask));
    EXPECT_TRUE(governor.Update(ReferenceOf(arm, q + h_s * dq, Taylor(zeta, h_s), subtask), h_s));
    return (governor.end_rad_s() - governor.start_rad_s()) / h_s;
  }

  static void ExpectFirstOrder(const PlanarArm& arm, const JointVector& q, const SubtaskConfig& subtask,
                               RandomArms& random) {
    const JointVector dq = random.Numbers(arm.dof(), 1.0);
    Zeta zeta = NearbyTarget(arm, q, random);
    zeta.x_m = arm.Position(arm.At(q)) + random.Numbers<TaskVector>(2, 5e-4);  // where the profile is linear
    const JointVector exact = AnalyticAcceleration(arm, q, dq, zeta, subtask);
    const auto error = [&](double h_s) {
      return (Difference(arm, q, dq, zeta, subtask, h_s) - exact).norm();
    };
    EXPECT_LT(error(1e-6), 1e-3 * (1.0 + exact.norm()));
    EXPECT_NEAR(error(2e-5) / error(1e-5), 2.0, 0.2);
  }
};

TEST_F(ExactDifference, TendsTo1_6AwayFromSingularities) {
  RandomArms random(6);
  SubtaskConfig subtask;
  subtask.kind = SubtaskKind::kPosture;
  subtask.joint = 2;
  subtask.goal_rad = 1.0;
  subtask.form = PostureForm::kPrinted;
  for (int id = 1; id <= 7; ++id) {
    const PlanarArm arm(PaperArm(id));
    const JointVector q = arm.dof() == 2 ? JointVector{{0.3, 1.2}} : JointVector{{0.3, 1.2, 0.7}};
    ASSERT_GT(SigmaMin(arm, q), 0.3);
    ExpectFirstOrder(arm, q, subtask, random);
  }
}

TEST_F(ExactDifference, TendsToTheDampedFormNearSingularities) {
  RandomArms random(7);
  SubtaskConfig subtask;
  subtask.kind = SubtaskKind::kManipulability;
  for (int id = 1; id <= 7; ++id) {
    const PlanarArm arm(PaperArm(id));
    const JointVector q = arm.dof() == 2 ? JointVector{{0.3, 0.2}} : JointVector{{0.3, 0.11, 0.1}};
    const double sigma = SigmaMin(arm, q);
    ASSERT_LT(sigma, 0.9 * kPseudoinverse.sigma_threshold_m);
    ASSERT_GT(sigma, 1e-2);
    ExpectFirstOrder(arm, q, subtask, random);
  }
}

}  // namespace
}  // namespace armada
