#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware/core/planar_arm.h"

namespace armada {

/// What one joint of an arm with three joints can do while the tip stays where it is, found by going along
/// the self-motion itself: a closed curve, followed step by step until it comes back.
struct SelfMotion {
  double lowest_rad = 0.0;  ///< of the joint, counted on from where it stands
  double highest_rad = 0.0;
  bool turns = false;  ///< the joint makes whole turns; then there are no bounds

  /// True when the joint can come to the angle `goal_rad`, whole turns and all.
  bool Contains(double goal_rad) const {
    return turns || (goal_rad >= lowest_rad && goal_rad <= highest_rad);
  }
  /// The same for any angle that is whole turns from `goal_rad`.
  bool ContainsModuloTurns(double goal_rad) const {
    constexpr double kTurn = 2.0 * std::numbers::pi;
    return turns || goal_rad + kTurn * std::ceil((lowest_rad - goal_rad) / kTurn) <= highest_rad;
  }
};

/// @pre dof == 3. By Euler steps of 9 mrad with a Newton correction each; `joint` from 0.
inline SelfMotion FollowSelfMotion(const PlanarArm& arm, const JointVector& start, int joint) {
  const TaskVector tip = arm.Position(arm.At(start));
  const auto tangent = [&](const Eigen::Vector3d& q) {
    const Eigen::Matrix<double, 2, 3> J = arm.Jacobian(arm.At(q));
    return Eigen::Vector3d(J.row(0).transpose().cross(J.row(1).transpose()).normalized());
  };
  SelfMotion motion{start[joint], start[joint], false};
  Eigen::Vector3d q = start;
  Eigen::Vector3d along = tangent(q);
  constexpr double kStep_rad = 9e-3;
  constexpr int kMostSteps = 5'000;
  for (int i = 0; i < kMostSteps; ++i) {
    Eigen::Vector3d next = tangent(q);
    if (next.dot(along) < 0.0) next = -next;
    along = next;
    q += kStep_rad * along;
    const PlanarArm::Posture at = arm.At(q);
    const Eigen::Matrix<double, 2, 3> J = arm.Jacobian(at);
    const Eigen::Vector2d off = tip - arm.Position(at);
    const Eigen::Matrix2d JJt = J * J.transpose();
    q += J.transpose() * (JJt.inverse() * off);
    motion.lowest_rad = std::min(motion.lowest_rad, q[joint]);
    motion.highest_rad = std::max(motion.highest_rad, q[joint]);
    const Eigen::Vector3d moved = q - Eigen::Vector3d(start);
    const Eigen::Vector3d apart =
        moved.unaryExpr([](double angle) { return std::remainder(angle, 2.0 * std::numbers::pi); });
    if (i < 10 || apart.norm() > 0.8 * kStep_rad) continue;
    motion.turns = std::abs(moved[joint]) > std::numbers::pi;
    return motion;
  }
  return motion;
}

}  // namespace armada
