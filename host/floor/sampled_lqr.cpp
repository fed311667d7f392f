#include "host/floor/sampled_lqr.h"

#include <cmath>

namespace armada {
namespace {

// The root inside the unit circle of z + 1/z = y, for y < -2.
double StableRoot(double y) {
  return 0.5 * (y + std::sqrt(y * y - 4.0));
}

}  // namespace

SampledLqr SampledLqr::Compute() {
  // The quartic is symmetric: with y = z + 1/z it is y^2 + 26 y + 64 = 0.
  const double z1 = StableRoot(-13.0 + std::sqrt(105.0));
  const double z2 = StableRoot(-13.0 - std::sqrt(105.0));
  const double alpha = -(z1 + z2);
  const double beta = z1 * z2;
  // z^2 + alpha z + beta is the characteristic polynomial of [1, h; 0, 1] - [h^2 / 2; h] [k1, k2].
  return {1.0 + alpha + beta, 0.5 * (3.0 + alpha - beta)};
}

}  // namespace armada
