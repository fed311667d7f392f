#include "firmware/core/projection.h"

#include <algorithm>
#include <cmath>

namespace armada {

void Project(const ProjectionConfig& config, const PlanarArm& arm, ParameterVector& theta) {
  const int n = arm.dof();
  for (int a = 0; a < n; ++a) {
    double& D_aa = theta[arm.InertiaIndex(a, a)];
    D_aa = std::clamp(D_aa, config.inertia_min_kgm2, config.inertia_max_kgm2);
  }
  const double c = config.correlation_max / std::max(1, n - 1);
  for (int a = 0; a < n; ++a) {
    for (int b = a + 1; b < n; ++b) {
      const double bound = c * std::sqrt(theta[arm.InertiaIndex(a, a)] * theta[arm.InertiaIndex(b, b)]);
      double& D_ab = theta[arm.InertiaIndex(a, b)];
      D_ab = std::clamp(D_ab, -bound, bound);
    }
  }
  for (int p = arm.InertiaParameterCount(); p < arm.parameter_count(); ++p) {
    theta[p] = std::clamp(theta[p], config.gravity_min_kgm, config.gravity_max_kgm);
  }
}

bool InProjectionSet(const ProjectionConfig& config, const PlanarArm& arm, const ParameterVector& theta) {
  ParameterVector projected = theta;
  Project(config, arm, projected);
  return (projected - theta).cwiseAbs().maxCoeff() <= 1e-9 * (1.0 + theta.cwiseAbs().maxCoeff());
}

}  // namespace armada
