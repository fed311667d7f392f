#pragma once

#include "firmware/core/parameter.h"
#include "firmware/core/planar_arm.h"

namespace armada {

/// Where theta_hat may be. D_aa within [min, max] and |D_ab| <= c sqrt(D_aa D_bb) with c = correlation_max /
/// (n - 1) keep [D_ab cos(th_a - th_b)] diagonally dominant after scaling, hence H_hat positive definite at
/// every q.
struct ProjectionConfig {
  double inertia_min_kgm2 = 1.0;
  double inertia_max_kgm2 = 40.0;
  double correlation_max = 0.9;
  double gravity_min_kgm = -5.0;
  double gravity_max_kgm = 25.0;

  void Visit(ParameterVisitor& parameter) {
    parameter({"inertia_min_kgm2", "kg m^2", 1e-9, 1e5, "smallest estimate of a diagonal inertia D_aa"},
              inertia_min_kgm2);
    parameter({"inertia_max_kgm2", "kg m^2", 1e-9, 1e5, "largest estimate of a diagonal inertia D_aa"},
              inertia_max_kgm2);
    parameter({"correlation_max", "", 0, 0.999,
               "bound on |D_ab| / sqrt(D_aa D_bb), times n - 1; below 1 keeps H_hat positive definite"},
              correlation_max);
    parameter({"gravity_min_kgm", "kg m", -1e5, 0, "smallest estimate of a gravity moment"}, gravity_min_kgm);
    parameter({"gravity_max_kgm", "kg m", 0, 1e5, "largest estimate of a gravity moment"}, gravity_max_kgm);
  }
};

/// Moves theta to the set above, component by component.
void Project(const ProjectionConfig& config, const PlanarArm& arm, ParameterVector& theta);

/// True when theta lies in the set (up to rounding): what the check of a fleet asks of the nominal
/// parameters.
bool InProjectionSet(const ProjectionConfig& config, const PlanarArm& arm, const ParameterVector& theta);

}  // namespace armada
