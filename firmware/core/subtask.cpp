#include "firmware/core/subtask.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace armada {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

JointVector Bounded(const JointVector& phi, double largest_rad_s) {
  const double largest = phi.cwiseAbs().maxCoeff();
  if (largest_rad_s <= 0.0 || largest <= largest_rad_s) return phi;
  return (largest_rad_s / largest) * phi;
}

bool Avoids(const SubtaskConfig& config, const PlanarArm& arm) {
  return config.avoidance.enabled && HasBarriers(arm.config());
}

/// Angle of joint j, from 0, up to whole turns, that self-motion passes least easily.
///
/// With the tip held, the links and the line from tip to base are a closed polygon, in which joint j is the
/// corner between link j and the side before it, which for the first joint is that line. As the joint turns,
/// the two sides fold flat on each other at one angle and stretch at another. The rest of the polygon allows
/// either or not; when a side at this corner is the longest of all it allows folding sooner, otherwise
/// stretching.
double CutAngle(const PlanarArm& arm, int j, const PlanarArm::Posture& at) {
  const TaskVector line = arm.Position(at) - arm.Base();
  double at_corner = j == 0 ? line.norm() : 0.0;
  double elsewhere = j == 0 ? 0.0 : line.norm();
  for (int i = 0; i < arm.dof(); ++i) {
    double& longest = i == j || i == j - 1 ? at_corner : elsewhere;
    longest = std::max(longest, arm.config().links[static_cast<size_t>(i)].l_m);
  }
  const bool folding_is_harder = elsewhere > at_corner;
  if (j > 0) return folding_is_harder ? std::numbers::pi : 0.0;
  // The first joint is folded when its link points at the tip.
  const double to_tip = std::atan2(line[1], line[0]) - arm.config().base_orientation_rad;
  return folding_is_harder ? to_tip : to_tip + std::numbers::pi;
}

}  // namespace

JointVector ManipulabilityGradient(const PlanarArm& arm, const PlanarArm::Posture& at,
                                   const JacobianMatrix& J) {
  const Eigen::Matrix2d JJt = J.lazyProduct(J.transpose());
  Eigen::Matrix2d adjugate;
  adjugate << JJt(1, 1), -JJt(0, 1), -JJt(1, 0), JJt(0, 0);
  const JacobianMatrix weighted = adjugate * J;  // d det(G) = tr(adj(G) dG), dG = dJ J' + J dJ'
  JointVector gradient(arm.dof());
  for (int k = 0; k < arm.dof(); ++k) {
    const JacobianMatrix dJ = arm.JacobianRate(at, JointVector::Unit(arm.dof(), k));
    gradient[k] = 2.0 * weighted.cwiseProduct(dJ).sum();
  }
  return gradient;
}

bool HasGoalInEveryTurn(const SubtaskConfig& config, const PlanarArmConfig& arm) {
  const bool limited = arm.q_min_rad.size() > 0 || arm.q_max_rad.size() > 0;
  return config.form == PostureForm::kExact && !limited;
}

double PostureError(const SubtaskConfig& config, const PlanarArm& arm, const JointVector& q,
                    const PlanarArm::Posture& at) {
  const int j = config.joint - 1;
  const double error = config.goal_rad - q[j];
  if (!HasGoalInEveryTurn(config, arm.config())) return error;
  const double cut = CutAngle(arm, j, at);
  const auto turn = [&](double angle) { return std::floor((angle - cut) / kTurn); };
  return error + kTurn * (turn(q[j]) - turn(config.goal_rad));
}

double PostureDistance(const SubtaskConfig& config, const PlanarArmConfig& arm, const JointVector& q) {
  const double error = config.goal_rad - q[config.joint - 1];
  return std::abs(HasGoalInEveryTurn(config, arm) ? std::remainder(error, kTurn) : error);
}

JointVector PrintedSubtaskVelocity(const SubtaskConfig& config, const PlanarArm& arm, const JointVector& q,
                                   const PlanarArm::Posture& at, const JacobianMatrix& J) {
  JointVector phi = JointVector::Zero(arm.dof());
  switch (config.kind) {
    case SubtaskKind::kNone:
      return phi;
    case SubtaskKind::kPosture:
      phi[config.joint - 1] = config.gain * (config.goal_rad - q[config.joint - 1]);
      break;
    case SubtaskKind::kManipulability:
      phi = config.gain * ManipulabilityGradient(arm, at, J);
      break;
  }
  return Bounded(phi, config.phi_max_rad_s);
}

bool HasSubtask(const SubtaskConfig& config, const PlanarArm& arm) {
  return arm.dof() > PlanarArm::kTaskDim && (config.kind != SubtaskKind::kNone || Avoids(config, arm));
}

JointVector SubtaskVelocity(const SubtaskConfig& config, const PlanarArm& arm, const SubtaskState& state) {
  const JointMatrix null_space =
      JointMatrix::Identity(arm.dof(), arm.dof()) - state.J_sharp.lazyProduct(state.J);
  JointVector phi;
  if (config.kind == SubtaskKind::kPosture && config.form == PostureForm::kExact) {
    const int j = config.joint - 1;
    const double rate = config.gain * PostureError(config, arm, state.q, state.at) - state.dq_main[j];
    phi = null_space.col(j) * (rate / std::max(null_space(j, j), config.freedom_min));
    phi = Bounded(phi, config.phi_max_rad_s);
  } else {
    phi = PrintedSubtaskVelocity(config, arm, state.q, state.at, state.J);
  }
  if (!Avoids(config, arm)) return phi;
  return Avoid(config.avoidance, arm, state.q, state.at, null_space, state.dq_main, phi);
}

}  // namespace armada
