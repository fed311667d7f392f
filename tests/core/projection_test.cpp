#include "firmware/core/projection.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "tests/core/paper_setting.h"
#include "tests/support/random_arms.h"

namespace armada {
namespace {

const ProjectionConfig kProjection;

double SmallestEigenvalue(const Eigen::MatrixXd& matrix) {
  return matrix.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff();
}

TEST(Projection, EndsInTheSetAndStaysThere) {
  RandomArms random(1);
  for (const PlanarArm& arm : random.AllKinds(50)) {
    ParameterVector theta = random.Numbers<ParameterVector>(arm.parameter_count(), 100.0);
    Project(kProjection, arm, theta);
    EXPECT_TRUE(InProjectionSet(kProjection, arm, theta));
    const ParameterVector once = theta;
    Project(kProjection, arm, theta);
    EXPECT_EQ(theta, once);
  }
}

TEST(Projection, KeepsTheEstimatedInertiaPositiveDefinite) {
  RandomArms random(2);
  for (const PlanarArm& arm : random.AllKinds(20)) {
    ParameterVector theta = random.Numbers<ParameterVector>(arm.parameter_count(), 100.0);
    Project(kProjection, arm, theta);
    for (int trial = 0; trial < 10; ++trial) {
      const JointMatrix H_hat = arm.Inertia(arm.At(random.Numbers(arm.dof(), 5.0)), theta);
      EXPECT_GT(SmallestEigenvalue(H_hat), 0.0);
    }
  }
}

TEST(Projection, WithoutItTheEstimateCanBeIndefinite) {
  const PlanarArm arm(PaperArm(1));
  ParameterVector theta{{1.0, 5.0, 1.0}};  // in the paper's box of starts
  const PlanarArm::Posture stretched = arm.At(JointVector::Zero(2));
  EXPECT_LT(SmallestEigenvalue(arm.Inertia(stretched, theta)), 0.0);
  Project(kProjection, arm, theta);
  EXPECT_GT(SmallestEigenvalue(arm.Inertia(stretched, theta)), 0.0);
}

TEST(Projection, HoldsEveryBound) {
  RandomArms random(3);
  for (const PlanarArm& arm : random.AllKinds(20)) {
    ParameterVector theta = random.Numbers<ParameterVector>(arm.parameter_count(), 100.0);
    Project(kProjection, arm, theta);
    for (int a = 0; a < arm.dof(); ++a) {
      const double D_aa = theta[arm.InertiaIndex(a, a)];
      EXPECT_GE(D_aa, kProjection.inertia_min_kgm2);
      EXPECT_LE(D_aa, kProjection.inertia_max_kgm2);
      for (int b = a + 1; b < arm.dof(); ++b) {
        const double D_bb = theta[arm.InertiaIndex(b, b)];
        const double share = kProjection.correlation_max / (arm.dof() - 1);
        EXPECT_LE(std::abs(theta[arm.InertiaIndex(a, b)]), share * std::sqrt(D_aa * D_bb) * (1.0 + 1e-12));
      }
    }
    for (int p = arm.InertiaParameterCount(); p < arm.parameter_count(); ++p) {
      EXPECT_GE(theta[p], kProjection.gravity_min_kgm);
      EXPECT_LE(theta[p], kProjection.gravity_max_kgm);
    }
  }
}

TEST(Projection, LeavesThePapersArmsAlone) {
  for (int id = 1; id <= 7; ++id) {
    for (const double gravity_m_s2 : {0.0, 9.81}) {
      PlanarArmConfig config = PaperArm(id);
      config.gravity_m_s2 = gravity_m_s2;
      const PlanarArm arm(config);
      EXPECT_TRUE(InProjectionSet(kProjection, arm, arm.Theta())) << "arm " << id;
      ParameterVector theta = arm.Theta();
      Project(kProjection, arm, theta);
      EXPECT_EQ(theta, arm.Theta());
    }
  }
}

TEST(Projection, MembershipSeesEachBound) {
  PlanarArmConfig config = PaperArm(1);
  config.gravity_m_s2 = 9.81;
  const PlanarArm arm(config);
  const ParameterVector inside = arm.Theta();
  const auto with = [&](int index, double value) {
    ParameterVector theta = inside;
    theta[index] = value;
    return InProjectionSet(kProjection, arm, theta);
  };
  EXPECT_TRUE(InProjectionSet(kProjection, arm, inside));
  EXPECT_FALSE(with(0, kProjection.inertia_min_kgm2 - 0.01));
  EXPECT_FALSE(with(2, kProjection.inertia_max_kgm2 + 0.01));
  EXPECT_FALSE(with(1, std::sqrt(inside[0] * inside[2])));
  EXPECT_FALSE(with(1, -std::sqrt(inside[0] * inside[2])));
  EXPECT_FALSE(with(3, kProjection.gravity_min_kgm - 0.01));
  EXPECT_FALSE(with(4, kProjection.gravity_max_kgm + 0.01));
}

}  // namespace
}  // namespace armada
