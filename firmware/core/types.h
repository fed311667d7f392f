#pragma once

#include <Eigen/Core>

namespace armada {

/// Compile-time maxima. Storage is fixed and lives inside the objects; sizes are set at run time, so that one
/// binary serves every arm without a heap.
inline constexpr int kMaxDof = 7;
inline constexpr int kMaxTaskDim = 3;
inline constexpr int kMaxParameters =
    kMaxDof * (kMaxDof + 1) / 2 + kMaxDof;  // inertia products, gravity moments
inline constexpr int kMaxArms = 64;
inline constexpr int kMaxNeighbours = kMaxArms;  // whom one node may hear: the leader and every other arm

template <int kMaxRows>
using BoundedVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxRows, 1>;
template <int kMaxRows, int kMaxCols>
using BoundedMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxRows, kMaxCols>;

using JointVector = BoundedVector<kMaxDof>;                      ///< p: q, dq, tau, s
using TaskVector = BoundedVector<kMaxTaskDim>;                   ///< m: x, v, a
using ParameterVector = BoundedVector<kMaxParameters>;           ///< theta
using JointMatrix = BoundedMatrix<kMaxDof, kMaxDof>;             ///< p x p: H, C
using JacobianMatrix = BoundedMatrix<kMaxTaskDim, kMaxDof>;      ///< m x p: J
using InverseMatrix = BoundedMatrix<kMaxDof, kMaxTaskDim>;       ///< p x m: J#
using TaskMatrix = BoundedMatrix<kMaxTaskDim, kMaxTaskDim>;      ///< m x m: K_x
using RegressorMatrix = BoundedMatrix<kMaxDof, kMaxParameters>;  ///< p x theta: Y
using ParameterMatrix = BoundedMatrix<kMaxParameters, kMaxParameters>;

}  // namespace armada
