#pragma once

#include "firmware/core/parameter.h"
#include "firmware/core/types.h"

namespace armada {

/// Damping of J# near singularities: l(sigma)^2 = l_max^2 (1 - (sigma / sigma_threshold)^2) below the
/// threshold, 0 above.
struct PseudoinverseConfig {
  double damping_max_m = 0.1;
  double sigma_threshold_m = 0.15;

  void Visit(ParameterVisitor& parameter) {
    parameter(
        {"damping_max_m", "m/rad", 0, 10, "damping l_max of J# at a singularity; 0 gives the undamped J#"},
        damping_max_m);
    parameter({"sigma_threshold_m", "m/rad", 1e-6, 10, "singular value of J below which J# is damped"},
              sigma_threshold_m);
  }
};

struct Pseudoinverse {
  InverseMatrix J_sharp;         ///< n x m
  double sigma_min = 0.0;        ///< smallest singular value of J, m/rad
  double determinant_JJt = 0.0;  ///< det(J J'), the paper's manipulability
};

/// J# of a wide or square J (m <= n): J' sum_k u_k u_k' / (sigma_k^2 + l(sigma_k)^2), with J J' = sum_k
/// sigma_k^2 u_k u_k'. Only weak directions are damped. Undamped it is J^-1 (m = n) or J'(J J')^-1 (m < n),
/// and Lemma 1 holds; a singular J with l_max = 0 gives non-finite values.
Pseudoinverse DampedPseudoinverse(const PseudoinverseConfig& config, const JacobianMatrix& J);

}  // namespace armada
