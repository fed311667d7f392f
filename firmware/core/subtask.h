#pragma once

#include "firmware/core/planar_arm.h"

namespace armada {

enum class SubtaskKind {
  kNone,
  kPosture,         ///< phi = k (q_goal - q) on one joint: the paper's arm 6
  kManipulability,  ///< phi = k d det(J J') / dq: the paper's arm 7
};

struct SubtaskConfig {
  SubtaskKind kind = SubtaskKind::kNone;
  int joint = 1;          ///< posture: joint number, from 1
  double goal_rad = 0.0;  ///< posture: its goal
  double gain = 1.0;      ///< posture: 1/s; manipulability: rad/(s m^4)
  double phi_max_rad_s = 3.0;

  template <class Visitor>
  void Visit(Visitor& parameter) {
    parameter({"kind", "", 0, 0, "use of spare joints: none, posture, manipulability"}, kind);
    parameter({"joint", "", 1, kMaxDof, "posture: number of the joint, from 1"}, joint);
    parameter({"goal_rad", "rad", -100, 100, "posture: goal of that joint"}, goal_rad);
    parameter({"gain", "1/s or rad/(s m^4)", 0, 1e3,
               "posture: k of phi = k (goal - q); manipulability: factor of the gradient"},
              gain);
    parameter({"phi_max_rad_s", "rad/s", 0, 100,
               "phi is scaled to at most this, in the largest component; 0: no bound"},
              phi_max_rad_s);
  }
};

/// phi_i of (1.5): joint velocity wanted by the subtask, n components. `J` is the Jacobian at `q`.
JointVector SubtaskVelocity(const SubtaskConfig& config, const PlanarArm& arm, const JointVector& q,
                            const PlanarArm::Posture& at, const JacobianMatrix& J);

/// d det(J J') / dq, analytic: 2 det(J J') tr((J J')^-1 J dJ/dq_k'), written with the adjugate so that it
/// holds at singularities too. m = 2.
JointVector ManipulabilityGradient(const PlanarArm& arm, const PlanarArm::Posture& at,
                                   const JacobianMatrix& J);

}  // namespace armada
