#include "firmware/core/implicit_control.h"

#include <algorithm>
#include <cmath>

namespace armada {

JointVector MinimizeWithL1(const ImplicitControlConfig& config, const JointMatrix& A, const JointVector& b,
                           const JointVector& w) {
  JointVector s = JointVector::Zero(b.size());
  for (int sweep = 0; sweep < config.sweeps; ++sweep) {
    double largest_move = 0.0;
    for (Eigen::Index i = 0; i < b.size(); ++i) {
      double rest = b[i] + A(i, i) * s[i];
      for (Eigen::Index j = 0; j < b.size(); ++j) rest -= A(i, j) * s[j];
      const double shrunk = std::copysign(std::max(0.0, std::abs(rest) - w[i]), rest) / A(i, i);
      largest_move = std::max(largest_move, std::abs(shrunk - s[i]));
      s[i] = shrunk;
    }
    if (largest_move <= config.tolerance_rad_s) break;
  }
  return s;
}

}  // namespace armada
