#include "firmware/core/implicit_control.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/core/paper_setting.h"
#include "tests/support/random_arms.h"

namespace armada {
namespace {

const ImplicitControlConfig kImplicit;

// H of a random arm plus damping: what the law minimises over.
JointMatrix RandomStiffness(RandomArms& random, int dof) {
  const PlanarArm arm(random.Config(dof));
  JointMatrix A = arm.Inertia(arm.At(random.Numbers(dof, 5.0)), arm.Theta());
  A.diagonal().array() += 1.5;
  return A;
}

// 0 in A s - b + diag(w) Sgn(s), the condition of optimality; the minimum is unique.
void ExpectOptimal(const JointMatrix& A, const JointVector& b, const JointVector& w, const JointVector& s) {
  const JointVector slope = A * s - b;
  for (Eigen::Index i = 0; i < s.size(); ++i) {
    const double tolerance = 1e-8 * (1.0 + b.norm());
    if (s[i] != 0.0) {
      EXPECT_NEAR(slope[i], s[i] > 0.0 ? -w[i] : w[i], tolerance);
    } else {
      EXPECT_LE(std::abs(slope[i]), w[i] + tolerance);
    }
  }
}

TEST(MinimizeWithL1, MeetsTheConditionOfOptimality) {
  RandomArms random(1);
  ImplicitControlConfig thorough;
  thorough.sweeps = 1000;
  int zeros = 0;
  for (int trial = 0; trial < 1400; ++trial) {
    const int dof = 1 + trial % kMaxDof;
    const JointMatrix A = RandomStiffness(random, dof);
    const JointVector b = random.Numbers(dof, 2.0);
    const JointVector w = random.Numbers(dof, 1.0).cwiseAbs();
    const JointVector s = MinimizeWithL1(thorough, A, b, w);
    ExpectOptimal(A, b, w, s);
    zeros += static_cast<int>((s.array() == 0.0).count());
  }
  EXPECT_GT(zeros, 100);
}

// The bound on sweeps is enough for the arms it is meant for.
TEST(MinimizeWithL1, ConvergesWithinItsSweepsForThePapersArms) {
  RandomArms random(2);
  for (int trial = 0; trial < 700; ++trial) {
    const PlanarArm arm(PaperArm(1 + trial % 7));
    const JointMatrix H = arm.Inertia(arm.At(random.Numbers(arm.dof(), 5.0)), arm.Theta());
    const JointMatrix A = H + 0.01 * 100.0 * JointMatrix::Identity(arm.dof(), arm.dof());
    const JointVector b = H * random.Numbers(arm.dof(), 2.0);
    const JointVector w = JointVector::Constant(arm.dof(), 0.01 * 60.0);
    ExpectOptimal(A, b, w, MinimizeWithL1(kImplicit, A, b, w));
  }
}

TEST(MinimizeWithL1, IsExactlyZeroInsideTheDeadBand) {
  RandomArms random(3);
  for (int dof = 1; dof <= kMaxDof; ++dof) {
    const JointMatrix A = RandomStiffness(random, dof);
    const JointVector w = JointVector::Constant(dof, 0.6);
    EXPECT_EQ(MinimizeWithL1(kImplicit, A, random.Numbers(dof, 0.6), w), JointVector::Zero(dof));
  }
}

TEST(MinimizeWithL1, WithoutWeightsSolvesTheLinearSystem) {
  RandomArms random(4);
  const JointMatrix A = RandomStiffness(random, 3);
  const JointVector b = random.Numbers(3, 2.0);
  ImplicitControlConfig thorough;
  thorough.sweeps = 1000;
  const JointVector s = MinimizeWithL1(thorough, A, b, JointVector::Zero(3));
  EXPECT_LT((A * s - b).norm(), 1e-9);
}

// As h -> 0 away from s = 0, (s+ - s)/h is the explicit H^-1 (-K s - K_r sgn(s)) of (1.2).
TEST(MinimizeWithL1, TendsToTheExplicitSgnForShortPeriods) {
  RandomArms random(5);
  const JointMatrix H = RandomStiffness(random, 3);
  const JointVector s{{0.5, -0.8, 0.3}};
  const JointMatrix K = 100.0 * JointMatrix::Identity(3, 3);
  const JointVector K_r = JointVector::Constant(3, 60.0);
  const JointVector explicit_rate = H.inverse() * (-K * s - K_r.cwiseProduct(s.cwiseSign()));
  const auto error = [&](double h_s) {
    const JointVector next =
        MinimizeWithL1({.sweeps = 1000, .tolerance_rad_s = 0.0}, H + h_s * K, H * s, h_s * K_r);
    return ((next - s) / h_s - explicit_rate).norm();
  };
  EXPECT_LT(error(1e-6), 1e-4 * explicit_rate.norm());
  EXPECT_NEAR(error(2e-4) / error(1e-4), 2.0, 0.1);
}

}  // namespace
}  // namespace armada
