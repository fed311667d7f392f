#include "firmware/core/pseudoinverse.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace armada {
namespace {

template <int kDim>
Pseudoinverse Compute(const PseudoinverseConfig& config, const JacobianMatrix& J) {
  using Square = Eigen::Matrix<double, kDim, kDim>;
  const Square JJt = J.lazyProduct(J.transpose());
  Eigen::SelfAdjointEigenSolver<Square> eigen;
  eigen.computeDirect(JJt);

  Square inverse = Square::Zero();
  Pseudoinverse result;
  for (int k = 0; k < kDim; ++k) {
    const double sigma_squared = std::max(eigen.eigenvalues()[k], 0.0);
    const double ratio = std::sqrt(sigma_squared) / config.sigma_threshold_m;
    const double l_squared =
        ratio < 1.0 ? config.damping_max_m * config.damping_max_m * (1.0 - ratio * ratio) : 0.0;
    inverse +=
        eigen.eigenvectors().col(k) * eigen.eigenvectors().col(k).transpose() / (sigma_squared + l_squared);
  }
  result.sigma_min = std::sqrt(std::max(eigen.eigenvalues()[0], 0.0));
  result.determinant_JJt = JJt.determinant();
  result.J_sharp = J.transpose().lazyProduct(inverse);
  return result;
}

}  // namespace

Pseudoinverse DampedPseudoinverse(const PseudoinverseConfig& config, const JacobianMatrix& J) {
  switch (J.rows()) {
    case 1:
      return Compute<1>(config, J);
    case 2:
      return Compute<2>(config, J);
    default:
      return Compute<3>(config, J);
  }
}

}  // namespace armada
