#pragma once

#include "firmware/core/avoidance.h"
#include "firmware/core/parameter.h"

namespace armada {

enum class SubtaskKind {
  kNone,
  kPosture,         ///< one joint goes to an angle: the paper's arm 6
  kManipulability,  ///< phi = k d det(J J') / dq: the paper's arm 7
};

constexpr auto EnumNames(SubtaskKind) {
  using enum SubtaskKind;
  return std::to_array<EnumName<SubtaskKind>>(
      {{kNone, "none"}, {kPosture, "posture"}, {kManipulability, "manipulability"}});
}

enum class PostureForm {
  kPrinted,  ///< phi = k (goal - q_j) e_j: what (I - J#J) leaves of it moves the joint
  kExact,    ///< phi such that the joint itself moves by k (goal - q_j), whatever the maintask does to it
};

constexpr auto EnumNames(PostureForm) {
  using enum PostureForm;
  return std::to_array<EnumName<PostureForm>>({{kPrinted, "printed"}, {kExact, "exact"}});
}

struct SubtaskConfig {
  SubtaskKind kind = SubtaskKind::kNone;
  int joint = 1;          ///< posture: joint number, from 1
  double goal_rad = 0.0;  ///< posture: its goal
  double gain = 1.0;      ///< posture: 1/s; manipulability: rad/(s m^4)
  double phi_max_rad_s = 3.0;
  PostureForm form = PostureForm::kExact;
  double freedom_min = 0.02;
  AvoidanceConfig avoidance;

  void Visit(ParameterVisitor& parameter) {
    parameter({"kind", "", 0, 0, "use of spare joints: none, posture, manipulability"}, kind);
    parameter({"joint", "", 1, kMaxDof, "posture: number of the joint, from 1"}, joint);
    parameter(
        {"goal_rad", "rad", -100, 100,
         "posture: goal of that joint; of a joint without limits any angle a whole turn away is one, too"},
        goal_rad);
    parameter({"gain", "1/s or rad/(s m^4)", 0, 1e3,
               "posture: k of dq = k (goal - q); manipulability: factor of the gradient"},
              gain);
    parameter({"phi_max_rad_s", "rad/s", 0, 100,
               "phi is scaled to at most this, in the largest component; 0: no bound"},
              phi_max_rad_s);
    parameter({"form", "", 0, 0,
               "posture: exact: the joint itself closes in by k (goal - q); printed: phi_j = k (goal - q_j), "
               "projected, as the paper has it, without whole turns; law = \"paper\" always takes this"},
              form);
    parameter({"freedom_min", "", 1e-6, 1,
               "posture, exact: share of the joint's motion that the maintask leaves free, below which less "
               "than k (goal - q) is asked for"},
              freedom_min);
    parameter.Table("avoidance", avoidance);
  }
};

/// Where a subtask is evaluated.
struct SubtaskState {
  const JointVector& q;
  const PlanarArm::Posture& at;
  const JacobianMatrix& J;
  const InverseMatrix& J_sharp;
  const JointVector& dq_main;  ///< J# r: what the maintask does to the joints
};

/// True when there is a use for the arm's spare joints, and there are any.
bool HasSubtask(const SubtaskConfig& config, const PlanarArm& arm);

/// phi_i of (1.5): joint velocity wanted by the subtask, n components. The avoidance of limits and obstacles
/// goes before what `kind` wants.
JointVector SubtaskVelocity(const SubtaskConfig& config, const PlanarArm& arm, const SubtaskState& state);

/// phi_i as printed: k (goal - q_j) e_j, or k d det(J J') / dq; scaled to its bound.
JointVector PrintedSubtaskVelocity(const SubtaskConfig& config, const PlanarArm& arm, const JointVector& q,
                                   const PlanarArm::Posture& at, const JacobianMatrix& J);

/// goal - q_j, rad: from the joint to the goal that it is led to. A joint without limits has a goal in every
/// turn, and is led to that one which it reaches without passing the angle where the self-motion of the arm
/// is most easily blocked: docs/subtasks.md.
double PostureError(const SubtaskConfig& config, const PlanarArm& arm, const JointVector& q,
                    const PlanarArm::Posture& at);

/// True when whole turns make no difference to the posture's goal: its form is exact, and the joints have no
/// limits.
bool HasGoalInEveryTurn(const SubtaskConfig& config, const PlanarArmConfig& arm);

/// How far the posture's joint is from the nearest of its goals, rad.
double PostureDistance(const SubtaskConfig& config, const PlanarArmConfig& arm, const JointVector& q);

/// d det(J J') / dq, analytic: 2 det(J J') tr((J J')^-1 J dJ/dq_k'), written with the adjugate so that it
/// holds at singularities too. m = 2.
JointVector ManipulabilityGradient(const PlanarArm& arm, const PlanarArm::Posture& at,
                                   const JacobianMatrix& J);

}  // namespace armada
