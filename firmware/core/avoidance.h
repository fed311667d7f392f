#pragma once

#include <limits>

#include "firmware/core/parameter.h"
#include "firmware/core/planar_arm.h"

namespace armada {

/// What spare joints do before any other subtask: they keep joints from their limits and links from
/// obstacles.
///
/// Each limit and each pair of link and obstacle is a barrier: a distance d(q) that may shrink no faster than
/// d' >= -rate d, so that it is neared ever more slowly and never passed. phi is the velocity nearest to what
/// the subtask wants that keeps all barriers as far as motion within the null space of J can,
///   phi = argmin 1/2 |phi - wanted|^2 + weight/2 sum_k max(0, -rate d_k - d_k'(dq_main + (I - J#J) phi))^2,
/// with the joints' velocity dq_main = J# r for the maintask counted in. The maintask has priority: a barrier
/// that it runs into, and that no motion of spare joints can change, is passed.
struct AvoidanceConfig {
  bool enabled = true;
  double clearance_m = 0.05;
  double joint_margin_rad = 0.05;
  double rate_1_s = 5.0;
  double weight = 1000.0;
  double phi_max_rad_s = 6.0;
  int steps = 10;
  int halvings = 5;
  double tolerance_rad_s = 1e-9;

  void Visit(ParameterVisitor& parameter) {
    parameter(
        {"enabled", "", 0, 1, "keep the arm from its joints' limits and its obstacles, where it has any"},
        enabled);
    parameter({"clearance_m", "m", 0, 10, "distance kept between the arm's links and its obstacles"},
              clearance_m);
    parameter({"joint_margin_rad", "rad", 0, 10, "distance kept from the joints' limits"}, joint_margin_rad);
    parameter({"rate_1_s", "1/s", 1e-3, 1e3,
               "a distance d to a limit or an obstacle shrinks at most by rate d; at most 1/period"},
              rate_1_s);
    parameter({"weight", "", 1e-3, 1e9,
               "weight of what a distance shrinks too fast, squared, against leaving the subtask's own "
               "velocity, squared"},
              weight);
    parameter({"phi_max_rad_s", "rad/s", 1e-3, 100,
               "phi with avoidance is scaled to at most this, in the largest component"},
              phi_max_rad_s);
    parameter({"steps", "", 1, 100, "bound on Newton's steps to phi"}, steps);
    parameter({"halvings", "", 0, 50, "bound on halvings of one of them until it is a gain"}, halvings);
    parameter({"tolerance_rad_s", "rad/s", 0, 1e-3, "they end when no component of phi moves by more"},
              tolerance_rad_s);
  }
};

/// True when the arm has limits or obstacles to keep from.
bool HasBarriers(const PlanarArmConfig& arm);

/// phi with avoidance. `null_space` is I - J#J, n x n.
JointVector Avoid(const AvoidanceConfig& config, const PlanarArm& arm, const JointVector& q,
                  const PlanarArm::Posture& at, const JointMatrix& null_space, const JointVector& dq_main,
                  const JointVector& wanted);

/// Least distance of any link from any obstacle, negative inside; infinite without obstacles.
double ClearanceOf(const PlanarArm& arm, const JointVector& q);

/// Least distance of any joint from one of its limits, negative beyond; infinite without limits.
double LimitMarginOf(const PlanarArm& arm, const JointVector& q);

}  // namespace armada
