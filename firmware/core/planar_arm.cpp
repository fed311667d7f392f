#include "firmware/core/planar_arm.h"

#include <algorithm>
#include <cmath>

namespace armada {
namespace {

// T a: cumulative sum, joint -> absolute.
JointVector Accumulate(const JointVector& a) {
  JointVector sum(a.size());
  double total = 0.0;
  for (Eigen::Index i = 0; i < a.size(); ++i) sum[i] = total += a[i];
  return sum;
}

// M <- T' M, column by column: suffix sums, absolute -> joint torques.
template <class Matrix>
void ApplyTransposedSum(Matrix& matrix) {
  for (Eigen::Index row = matrix.rows() - 2; row >= 0; --row) {
    for (Eigen::Index col = 0; col < matrix.cols(); ++col) matrix(row, col) += matrix(row + 1, col);
  }
}

// M <- M T.
void ApplySum(JointMatrix& matrix) {
  for (Eigen::Index col = matrix.cols() - 2; col >= 0; --col) {
    for (Eigen::Index row = 0; row < matrix.rows(); ++row) matrix(row, col) += matrix(row, col + 1);
  }
}

double CosineOfDifference(const PlanarArm::Posture& at, int a, int b) {
  return at.cosine[a] * at.cosine[b] + at.sine[a] * at.sine[b];
}

double SineOfDifference(const PlanarArm::Posture& at, int a, int b) {
  return at.sine[a] * at.cosine[b] - at.cosine[a] * at.sine[b];
}

}  // namespace

PlanarArm::PlanarArm(const PlanarArmConfig& config) : config_(config) {
  double longest = 0.0;
  for (int i = 0; i < dof(); ++i) {
    const double length = config_.links[static_cast<size_t>(i)].l_m;
    reach_max_m_ += length;
    longest = std::max(longest, length);
  }
  reach_min_m_ = std::max(0.0, 2.0 * longest - reach_max_m_);
  parameter_count_ = InertiaParameterCount() + (config_.gravity_m_s2 != 0.0 ? dof() : 0);
}

TaskVector PlanarArm::Base() const {
  TaskVector base(kTaskDim);
  base << config_.base_x_m, config_.base_y_m;
  return base;
}

PlanarArm::Posture PlanarArm::At(const JointVector& q) const {
  Posture at{JointVector(dof()), JointVector(dof())};
  double angle = config_.base_orientation_rad;
  for (int i = 0; i < dof(); ++i) {
    angle += q[i];
    at.cosine[i] = std::cos(angle);
    at.sine[i] = std::sin(angle);
  }
  return at;
}

TaskVector PlanarArm::Position(const Posture& at) const {
  TaskVector x = Base();
  for (int i = 0; i < dof(); ++i) {
    const double l = config_.links[static_cast<size_t>(i)].l_m;
    x[0] += l * at.cosine[i];
    x[1] += l * at.sine[i];
  }
  return x;
}

JacobianMatrix PlanarArm::Jacobian(const Posture& at) const {
  JacobianMatrix J(kTaskDim, dof());
  double x = 0.0;
  double y = 0.0;
  for (int i = dof() - 1; i >= 0; --i) {
    const double l = config_.links[static_cast<size_t>(i)].l_m;
    J(0, i) = x -= l * at.sine[i];
    J(1, i) = y += l * at.cosine[i];
  }
  return J;
}

JacobianMatrix PlanarArm::JacobianRate(const Posture& at, const JointVector& dq) const {
  const JointVector W = Accumulate(dq);
  JacobianMatrix dJ(kTaskDim, dof());
  double x = 0.0;
  double y = 0.0;
  for (int i = dof() - 1; i >= 0; --i) {
    const double l = config_.links[static_cast<size_t>(i)].l_m;
    dJ(0, i) = x -= l * at.cosine[i] * W[i];
    dJ(1, i) = y -= l * at.sine[i] * W[i];
  }
  return dJ;
}

ParameterVector PlanarArm::Theta() const {
  // c_ka: lever of the absolute angle a on the centre of mass of link k.
  JointMatrix lever = JointMatrix::Zero(dof(), dof());
  for (int k = 0; k < dof(); ++k) {
    for (int a = 0; a < k; ++a) lever(k, a) = config_.links[static_cast<size_t>(a)].l_m;
    lever(k, k) = config_.links[static_cast<size_t>(k)].r_m;
  }
  ParameterVector theta = ParameterVector::Zero(parameter_count_);
  for (int a = 0; a < dof(); ++a) {
    for (int b = a; b < dof(); ++b) {
      double D_ab = a == b ? config_.links[static_cast<size_t>(a)].I_kgm2 : 0.0;
      for (int k = b; k < dof(); ++k)
        D_ab += config_.links[static_cast<size_t>(k)].m_kg * lever(k, a) * lever(k, b);
      theta[InertiaIndex(a, b)] = D_ab;
    }
    if (parameter_count_ > InertiaParameterCount()) {
      for (int k = a; k < dof(); ++k) {
        theta[InertiaParameterCount() + a] += config_.links[static_cast<size_t>(k)].m_kg * lever(k, a);
      }
    }
  }
  return theta;
}

RegressorMatrix PlanarArm::Regressor(const Posture& at, const JointVector& dq, const JointVector& y,
                                     const JointVector& x) const {
  const JointVector W = Accumulate(dq);
  const JointVector Ty = Accumulate(y);
  const JointVector Tx = Accumulate(x);
  RegressorMatrix Y = RegressorMatrix::Zero(dof(), parameter_count_);
  int column = 0;
  for (int a = 0; a < dof(); ++a) {
    Y(a, column++) = Tx[a];
    for (int b = a + 1; b < dof(); ++b, ++column) {
      const double c = CosineOfDifference(at, a, b);
      const double s = SineOfDifference(at, a, b);
      Y(a, column) = c * Tx[b] + s * W[b] * Ty[b];
      Y(b, column) = c * Tx[a] - s * W[a] * Ty[a];
    }
  }
  for (int a = 0; column < parameter_count_; ++a, ++column)
    Y(a, column) = config_.gravity_m_s2 * at.cosine[a];
  ApplyTransposedSum(Y);
  return Y;
}

JointMatrix PlanarArm::Inertia(const Posture& at, const ParameterVector& theta) const {
  JointMatrix H(dof(), dof());
  int index = 0;
  for (int a = 0; a < dof(); ++a) {
    for (int b = a; b < dof(); ++b, ++index) H(a, b) = H(b, a) = theta[index] * CosineOfDifference(at, a, b);
  }
  ApplyTransposedSum(H);
  ApplySum(H);
  return H;
}

JointMatrix PlanarArm::Coriolis(const Posture& at, const JointVector& dq,
                                const ParameterVector& theta) const {
  const JointVector W = Accumulate(dq);
  JointMatrix C = JointMatrix::Zero(dof(), dof());
  int index = 0;
  for (int a = 0; a < dof(); ++a) {
    for (int b = a; b < dof(); ++b, ++index) {
      const double D_sin = theta[index] * SineOfDifference(at, a, b);
      C(a, b) += D_sin * W[b];
      C(b, a) -= D_sin * W[a];
    }
  }
  ApplyTransposedSum(C);
  ApplySum(C);
  return C;
}

JointVector PlanarArm::Bias(const Posture& at, const JointVector& dq, const ParameterVector& theta) const {
  const JointVector W = Accumulate(dq);
  JointVector bias = JointVector::Zero(dof());
  int index = 0;
  for (int a = 0; a < dof(); ++a) {
    ++index;  // D_aa acts on acceleration only
    for (int b = a + 1; b < dof(); ++b, ++index) {
      const double D_sin = theta[index] * SineOfDifference(at, a, b);
      bias[a] += D_sin * W[b] * W[b];
      bias[b] -= D_sin * W[a] * W[a];
    }
  }
  for (int a = 0; index < parameter_count_; ++a, ++index) {
    bias[a] += config_.gravity_m_s2 * theta[index] * at.cosine[a];
  }
  ApplyTransposedSum(bias);
  return bias;
}

}  // namespace armada
