#include "firmware/core/pseudoinverse.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>

#include "tests/support/random_arms.h"

namespace armada {
namespace {

constexpr PseudoinverseConfig kUndamped{.damping_max_m = 0.0, .sigma_threshold_m = 0.15};
constexpr PseudoinverseConfig kDamped{.damping_max_m = 0.1, .sigma_threshold_m = 0.15};

// J = U diag(sigma) V' with random directions.
JacobianMatrix WithSingularValues(RandomArms& random, Eigen::Index joints, const Eigen::VectorXd& sigma) {
  const Eigen::MatrixXd seed =
      Eigen::MatrixXd::NullaryExpr(sigma.size(), joints, [&] { return random.In(-1.0, 1.0); });
  const auto svd = seed.jacobiSvd(Eigen::ComputeThinU | Eigen::ComputeThinV);
  return svd.matrixU() * sigma.asDiagonal() * svd.matrixV().transpose();
}

// Task dimension and joints: square and wide.
struct Shape {
  int m, n;
};
class EveryShape : public testing::TestWithParam<Shape> {
 protected:
  JacobianMatrix Draw() {
    const Shape shape = GetParam();
    Eigen::VectorXd sigma(shape.m);
    for (double& s : sigma) s = random_.In(0.2, 3.0);
    return WithSingularValues(random_, shape.n, sigma);
  }
  RandomArms random_{1};
};
INSTANTIATE_TEST_SUITE_P(Pseudoinverse, EveryShape,
                         testing::Values(Shape{2, 2}, Shape{2, 3}, Shape{2, 7}, Shape{3, 3}, Shape{3, 4},
                                         Shape{3, 7}));

TEST_P(EveryShape, UndampedSatisfiesLemma1) {
  for (int trial = 0; trial < 200; ++trial) {
    const JacobianMatrix J = Draw();
    const InverseMatrix J_sharp = DampedPseudoinverse(kUndamped, J).J_sharp;
    const JointMatrix N = JointMatrix::Identity(J.cols(), J.cols()) - J_sharp * J;
    EXPECT_LT((J * N).norm(), 1e-10);
    EXPECT_LT((N * J_sharp).norm(), 1e-10);
    EXPECT_LT((N * N - N).norm(), 1e-10);
  }
}

TEST_P(EveryShape, UndampedSatisfiesTheMoorePenroseConditions) {
  for (int trial = 0; trial < 200; ++trial) {
    const JacobianMatrix J = Draw();
    const InverseMatrix J_sharp = DampedPseudoinverse(kUndamped, J).J_sharp;
    EXPECT_LT((J * J_sharp * J - J).norm(), 1e-10);
    EXPECT_LT((J_sharp * J * J_sharp - J_sharp).norm(), 1e-10);
    EXPECT_LT((J * J_sharp - (J * J_sharp).transpose()).norm(), 1e-10);
    EXPECT_LT((J_sharp * J - (J_sharp * J).transpose()).norm(), 1e-10);
  }
}

TEST_P(EveryShape, ReportsSmallestSingularValueAndManipulability) {
  for (int trial = 0; trial < 200; ++trial) {
    const JacobianMatrix J = Draw();
    const Pseudoinverse result = DampedPseudoinverse(kDamped, J);
    const Eigen::VectorXd sigma = Eigen::MatrixXd(J).jacobiSvd().singularValues();
    EXPECT_NEAR(result.sigma_min, sigma.minCoeff(), 1e-10);
    EXPECT_NEAR(result.determinant_JJt, sigma.prod() * sigma.prod(),
                1e-10 * (1.0 + sigma.prod() * sigma.prod()));
  }
}

TEST(Pseudoinverse, OfASquareJacobianIsItsInverse) {
  RandomArms random(2);
  for (const int m : {2, 3}) {
    for (int trial = 0; trial < 100; ++trial) {
      const JacobianMatrix J = WithSingularValues(random, m, Eigen::VectorXd::LinSpaced(m, 0.3, 2.0));
      const Eigen::MatrixXd inverse = Eigen::MatrixXd(J).inverse();
      EXPECT_LT((DampedPseudoinverse(kUndamped, J).J_sharp - inverse).norm(), 1e-10);
    }
  }
}

TEST(Pseudoinverse, DampingLeavesRegularJacobiansAlone) {
  RandomArms random(3);
  const JacobianMatrix J = WithSingularValues(random, 3, Eigen::Vector2d(0.16, 2.0));
  EXPECT_EQ(DampedPseudoinverse(kDamped, J).J_sharp, DampedPseudoinverse(kUndamped, J).J_sharp);
}

// sigma / (sigma^2 + l^2(sigma)) has its maximum inside the damped range; it bounds |J#| however small sigma
// is.
TEST(Pseudoinverse, DampedStaysBoundedUpToAndAtTheSingularity) {
  double bound = 0.0;
  for (double s = 1e-4; s < 0.3; s += 1e-4) {
    const double ratio = std::min(1.0, s / kDamped.sigma_threshold_m);
    bound =
        std::max(bound, s / (s * s + kDamped.damping_max_m * kDamped.damping_max_m * (1.0 - ratio * ratio)));
  }
  RandomArms random(4);
  for (const double sigma : {0.15, 0.1, 0.05, 1e-2, 1e-4, 1e-8, 1e-12, 0.0}) {
    const JacobianMatrix J = WithSingularValues(random, 3, Eigen::Vector2d(sigma, 2.0));
    const Pseudoinverse result = DampedPseudoinverse(kDamped, J);
    ASSERT_TRUE(result.J_sharp.allFinite());
    EXPECT_LE(Eigen::MatrixXd(result.J_sharp).operatorNorm(), bound * (1.0 + 1e-6));
  }
  EXPECT_TRUE(DampedPseudoinverse(kDamped, JacobianMatrix::Zero(2, 2)).J_sharp.isZero());
}

TEST(Pseudoinverse, HasTheDocumentedGainInEachDirection) {
  RandomArms random(5);
  for (const double sigma : {0.14, 0.1, 0.03}) {
    const JacobianMatrix J = WithSingularValues(random, 4, Eigen::Vector3d(sigma, 0.5, 2.0));
    const auto svd = Eigen::MatrixXd(J).jacobiSvd(Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Eigen::MatrixXd gains =
        svd.matrixV().transpose() * DampedPseudoinverse(kDamped, J).J_sharp * svd.matrixU();
    const double ratio = sigma / kDamped.sigma_threshold_m;
    const double l_squared = kDamped.damping_max_m * kDamped.damping_max_m * (1.0 - ratio * ratio);
    const Eigen::Vector3d expected(1.0 / 2.0, 1.0 / 0.5, sigma / (sigma * sigma + l_squared));
    EXPECT_LT((gains - Eigen::MatrixXd(expected.asDiagonal())).norm(),
              1e-9);  // strong directions are undamped
  }
}

TEST(Pseudoinverse, IsContinuousAcrossTheThreshold) {
  RandomArms random(6);
  const JacobianMatrix base = WithSingularValues(random, 2, Eigen::Vector2d(1.0, 1.0));
  const Eigen::Matrix2d U = base;  // orthogonal
  const auto at = [&](double sigma) {
    return DampedPseudoinverse(kDamped, JacobianMatrix(U * Eigen::Vector2d(sigma, 2.0).asDiagonal())).J_sharp;
  };
  for (const double gap : {1e-3, 1e-5, 1e-7}) {
    const double jump = (at(kDamped.sigma_threshold_m + gap) - at(kDamped.sigma_threshold_m - gap)).norm();
    EXPECT_LT(jump, 100.0 * gap);
  }
}

TEST(Pseudoinverse, OfASingularJacobianWithoutDampingIsNotFinite) {
  JacobianMatrix J(2, 2);
  J << 1.0, 0.0, 0.0, 0.0;
  EXPECT_FALSE(DampedPseudoinverse(kUndamped, J).J_sharp.allFinite());
}

}  // namespace
}  // namespace armada
