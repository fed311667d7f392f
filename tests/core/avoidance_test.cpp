#include "firmware/core/avoidance.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <numbers>

#include "firmware/core/reference.h"
#include "tests/core/paper_setting.h"
#include "tests/support/random_arms.h"

namespace armada {
namespace {

ObstacleConfig RandomObstacle(RandomArms& random) {
  ObstacleConfig obstacle;
  obstacle.kind = random.In(0.0, 1.0) < 0.5 ? ObstacleKind::kDisc : ObstacleKind::kHalfPlane;
  obstacle.x_m = random.In(-3.0, 3.0);
  obstacle.y_m = random.In(-3.0, 3.0);
  obstacle.radius_m = random.In(0.05, 0.5);
  obstacle.normal_rad = random.In(-3.0, 3.0);
  return obstacle;
}

// Signed distance of a point from an obstacle.
double DistanceOf(const ObstacleConfig& obstacle, const Eigen::Vector2d& point) {
  const double x = point[0] - obstacle.x_m;
  const double y = point[1] - obstacle.y_m;
  if (obstacle.kind == ObstacleKind::kDisc) return std::hypot(x, y) - obstacle.radius_m;
  return x * std::cos(obstacle.normal_rad) + y * std::sin(obstacle.normal_rad);
}

TEST(Clearance, IsTheLeastDistanceOfAnyPointOfAnyLink) {
  RandomArms random(1);
  for (int trial = 0; trial < 100; ++trial) {
    PlanarArmConfig config = random.Config(3 + trial % 5);
    config.obstacle_count = 1 + trial % kMaxObstacles;
    for (ObstacleConfig& obstacle : config.obstacles) obstacle = RandomObstacle(random);
    const PlanarArm arm(config);
    const JointVector q = random.Numbers(arm.dof(), 5.0);

    constexpr int kPoints = 2000;  // a link
    double least_m = 1e9;
    Eigen::Vector2d start(config.base_x_m, config.base_y_m);
    double angle = config.base_orientation_rad;
    for (int i = 0; i < arm.dof(); ++i) {
      angle += q[i];
      const double l_m = config.links[static_cast<size_t>(i)].l_m;
      const Eigen::Vector2d along(l_m * std::cos(angle), l_m * std::sin(angle));
      for (int p = 1; p <= kPoints; ++p) {
        for (size_t k = 0; k < static_cast<size_t>(config.obstacle_count); ++k) {
          const double distance_m = DistanceOf(config.obstacles[k], start + (p * along) / kPoints);
          // The base itself cannot be behind a half-plane: the configuration is refused.
          least_m = std::min(least_m, distance_m);
        }
      }
      start += along;
    }
    const double base_to_wall_m = [&] {
      double least = 1e9;
      for (size_t k = 0; k < static_cast<size_t>(config.obstacle_count); ++k) {
        if (config.obstacles[k].kind == ObstacleKind::kHalfPlane)
          least = std::min(least, DistanceOf(config.obstacles[k], {config.base_x_m, config.base_y_m}));
      }
      return least;
    }();
    if (base_to_wall_m < least_m + 1e-2) continue;  // nearest to a wall is the base, which does not move
    EXPECT_NEAR(ClearanceOf(arm, q), least_m, 1e-3);
  }
}

TEST(Clearance, IsInfiniteWithoutObstacles) {
  const PlanarArm arm(PaperArm(6));
  EXPECT_TRUE(std::isinf(ClearanceOf(arm, JointVector::Zero(3))));
  EXPECT_TRUE(std::isinf(LimitMarginOf(arm, JointVector::Zero(3))));
}

TEST(LimitMargin, IsThatOfTheJointNearestToALimit) {
  PlanarArmConfig config = PaperArm(6);
  config.q_min_rad = JointVector{{-1.0, -2.0, -3.0}};
  config.q_max_rad = JointVector{{1.0, 2.0, 3.0}};
  EXPECT_DOUBLE_EQ(LimitMarginOf(PlanarArm(config), JointVector{{0.5, -1.75, 0.0}}), 0.25);
  EXPECT_DOUBLE_EQ(LimitMarginOf(PlanarArm(config), JointVector{{0.5, 0.0, 3.125}}), -0.125);
}

/// An arm at a state, and what avoidance makes of a wanted velocity.
struct Encounter {
  PlanarArm arm;
  JointVector q, dq_main, wanted;
  JointMatrix N;
  AvoidanceConfig config;

  JointVector Phi() const { return Avoid(config, arm, q, arm.At(q), N, dq_main, wanted); }
  JointVector Motion(const JointVector& phi) const { return dq_main + N * phi; }
  /// The distances, margins taken off, of each link from each obstacle and of each joint from its limit, and
  /// their rates along a motion: by differences, without a gradient.
  struct Barrier {
    double distance, rate;
  };
  std::vector<Barrier> Barriers(const JointVector& dq) const {
    constexpr double kStep_s = 1e-6;
    const std::vector<double> now = Distances(q);
    const std::vector<double> before = Distances(q - kStep_s * dq);
    const std::vector<double> after = Distances(q + kStep_s * dq);
    std::vector<Barrier> barriers;
    for (size_t k = 0; k < now.size(); ++k)
      barriers.push_back({now[k], (after[k] - before[k]) / (2.0 * kStep_s)});
    return barriers;
  }

 private:
  std::vector<double> Distances(const JointVector& at_q) const {
    std::vector<double> distances;
    const PlanarArmConfig& links = arm.config();
    Eigen::Vector2d start(links.base_x_m, links.base_y_m);
    double angle = links.base_orientation_rad;
    for (int i = 0; i < arm.dof(); ++i) {
      angle += at_q[i];
      const double l_m = links.links[static_cast<size_t>(i)].l_m;
      const Eigen::Vector2d end = start + l_m * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      for (size_t k = 0; k < static_cast<size_t>(links.obstacle_count); ++k)
        distances.push_back(SeparationOf(links.obstacles[k], start, end).distance_m - config.clearance_m);
      start = end;
    }
    for (Eigen::Index j = 0; j < links.q_min_rad.size(); ++j)
      distances.push_back(at_q[j] - links.q_min_rad[j] - config.joint_margin_rad);
    return distances;
  }
};

Encounter RandomEncounter(RandomArms& random, int dof, int obstacles, bool limits) {
  PlanarArmConfig config = random.Config(dof);
  const JointVector q = random.Numbers(dof, 4.0);
  if (limits) config.q_min_rad = q - JointVector::Constant(dof, 0.1) - 0.1 * random.Numbers(dof, 1.0);
  config.obstacle_count = obstacles;
  for (ObstacleConfig& obstacle : config.obstacles) obstacle = RandomObstacle(random);
  const PlanarArm arm(config);
  const JacobianMatrix J = arm.Jacobian(arm.At(q));
  const InverseMatrix J_sharp = DampedPseudoinverse({}, J).J_sharp;
  const JointMatrix N = JointMatrix::Identity(dof, dof) - J_sharp * J;
  return {arm, q, J_sharp * random.Numbers<TaskVector>(2, 0.3), random.Numbers(dof, 3.0), N, {}};
}

TEST(Avoid, ChangesNothingWhereNothingIsNear) {
  RandomArms random(2);
  for (int trial = 0; trial < 50; ++trial) {
    Encounter instant = RandomEncounter(random, 3 + trial % 5, 0, false);
    PlanarArmConfig config = instant.arm.config();
    config.obstacle_count = 1;
    config.obstacles[0] = {ObstacleKind::kDisc, 100.0, 100.0, 1.0, 0.0};
    config.q_min_rad = JointVector::Constant(config.dof, -100.0);
    instant.arm = PlanarArm(config);
    EXPECT_EQ(instant.Phi(), instant.wanted);
  }
}

// The argmin, found by brute force along the one spare direction that three joints have.
TEST(Avoid, IsTheNearestVelocityThatKeepsTheBarriers) {
  RandomArms random(3);
  int active = 0;
  for (int trial = 0; trial < 300; ++trial) {
    Encounter instant = RandomEncounter(random, 3, 3, true);
    if (DampedPseudoinverse({}, instant.arm.Jacobian(instant.arm.At(instant.q))).sigma_min < 0.2) continue;
    instant.config.phi_max_rad_s = 1e3;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(Eigen::Matrix3d(instant.N));
    const JointVector spare = eigen.eigenvectors().col(2);
    const double along = spare.dot(instant.wanted);

    const auto still = instant.Barriers(instant.dq_main);
    const auto moving = instant.Barriers(instant.dq_main + spare);
    const auto cost = [&](double speed) {
      double sum = 0.5 * (speed - along) * (speed - along);
      for (size_t k = 0; k < still.size(); ++k) {
        const double rate = still[k].rate + speed * (moving[k].rate - still[k].rate);
        const double shortfall = std::max(0.0, -instant.config.rate_1_s * still[k].distance - rate);
        sum += 0.5 * instant.config.weight * shortfall * shortfall;
      }
      return sum;
    };
    const double chosen = spare.dot(instant.Phi());
    for (double speed = -20.0; speed < 20.0; speed += 0.01) {
      EXPECT_LE(cost(chosen), cost(speed) + 1e-3 * (1.0 + cost(speed))) << "trial " << trial;
    }
    active += std::abs(chosen - along) > 1e-6;
  }
  EXPECT_GT(active, 30);
}

TEST(Avoid, LetsNoDistanceShrinkFasterThanAllowed) {
  RandomArms random(4);
  int active = 0;
  for (int trial = 0; trial < 300; ++trial) {
    Encounter instant = RandomEncounter(random, 5 + trial % 3, 1, true);
    if (DampedPseudoinverse({}, instant.arm.Jacobian(instant.arm.At(instant.q))).sigma_min < 0.2) continue;
    instant.dq_main *= 0.1;
    instant.config.phi_max_rad_s = 1e3;
    instant.config.weight = 1e8;
    const JointVector phi = instant.Phi();
    bool feasible = true;  // by standing still
    for (const auto& [distance, rate] : instant.Barriers(instant.dq_main))
      feasible = feasible && rate > -instant.config.rate_1_s * distance;
    if (!feasible) continue;
    for (const auto& [distance, rate] : instant.Barriers(instant.Motion(phi)))
      EXPECT_GT(rate, -instant.config.rate_1_s * distance - 1e-3) << "trial " << trial;
    active += (phi - instant.wanted).norm() > 1e-6;
  }
  EXPECT_GT(active, 30);
}

TEST(Avoid, IsBounded) {
  RandomArms random(5);
  for (int trial = 0; trial < 300; ++trial) {
    const Encounter instant = RandomEncounter(random, 3 + trial % 5, kMaxObstacles, true);
    const JointVector phi = instant.Phi();
    EXPECT_TRUE(phi.allFinite());
    EXPECT_LE(phi.cwiseAbs().maxCoeff(), instant.config.phi_max_rad_s * (1.0 + 1e-12));
  }
}

TEST(Avoid, IsFiniteWithALinkThroughTheCentreOfADisc) {
  PlanarArmConfig config = PaperArm(6);
  config.obstacle_count = 1;
  config.obstacles[0] = {ObstacleKind::kDisc, 0.4, 0.0, 0.1, 0.0};
  const PlanarArm arm(config);
  const JointVector q{{0.0, 1.0, 0.5}};
  EXPECT_NEAR(ClearanceOf(arm, q), -0.1, 1e-12);
  const JacobianMatrix J = arm.Jacobian(arm.At(q));
  const JointMatrix N = JointMatrix::Identity(3, 3) - DampedPseudoinverse({}, J).J_sharp * J;
  const JointVector zero = JointVector::Zero(3);
  const JointVector phi = Avoid({}, arm, q, arm.At(q), N, zero, zero);
  EXPECT_TRUE(phi.allFinite());
  EXPECT_GT(phi.norm(), 0.1) << "it leaves";
}

/// The reference followed exactly for some laps; what was kept in the last of them.
struct Kept {
  double clearance_m = 1e9;
  double margin_rad = 1e9;
  double error_m = 0.0;
};
Kept FollowTheLeader(const PlanarArmConfig& config, const SubtaskConfig& subtask) {
  const PlanarArm arm(config);
  JointVector q = JointVector::Constant(arm.dof(), 1.2);
  q[0] = 0.3;
  Kept kept;
  constexpr double kStep_s = 2e-3;
  for (double t_s = 0.0; t_s < 8.0; t_s += kStep_s) {
    const auto velocity = [&](double at_s, const JointVector& at) {
      return ReferenceVelocity({}, kApproach, {}, subtask, arm, at, PaperLeader(at_s), true);
    };
    const JointVector middle = q + 0.5 * kStep_s * velocity(t_s, q);
    q += kStep_s * velocity(t_s + 0.5 * kStep_s, middle);
    if (t_s < 4.0) continue;
    kept.clearance_m = std::min(kept.clearance_m, ClearanceOf(arm, q));
    kept.margin_rad = std::min(kept.margin_rad, LimitMarginOf(arm, q));
    kept.error_m = std::max(kept.error_m, (arm.Position(arm.At(q)) - PaperLeader(t_s + kStep_s).x_m).norm());
  }
  return kept;
}

TEST(AvoidanceOfArm6, KeepsLinksFromATableWhileTheTipFollowsTheLeader) {
  PlanarArmConfig config = PaperArm(6);
  config.obstacle_count = 1;
  config.obstacles[0] = {ObstacleKind::kHalfPlane, 0.0, -0.4, 0.0, 0.5 * std::numbers::pi};
  SubtaskConfig subtask;
  subtask.kind = SubtaskKind::kPosture;
  subtask.joint = 2;
  subtask.goal_rad = 1.0;
  subtask.gain = 9.0;
  const Kept with = FollowTheLeader(config, subtask);
  EXPECT_GT(with.clearance_m, 0.048);
  EXPECT_LT(with.error_m, 1e-4);
  subtask.avoidance.enabled = false;
  EXPECT_LT(FollowTheLeader(config, subtask).clearance_m, -0.1) << "else there would be nothing to show";
}

TEST(AvoidanceOfArm7, KeepsItsJointsWithinTheirLimitsWhileTheTipFollowsTheLeader) {
  PlanarArmConfig config = PaperArm(7);
  config.q_min_rad = JointVector::Constant(3, -3.0);
  config.q_max_rad = JointVector{{3.0, 1.0, 3.0}};
  SubtaskConfig subtask;
  subtask.kind = SubtaskKind::kManipulability;
  const Kept with = FollowTheLeader(config, subtask);
  EXPECT_GT(with.margin_rad, 0.048);
  EXPECT_LT(with.error_m, 1e-4);
  subtask.avoidance.enabled = false;
  EXPECT_LT(FollowTheLeader(config, subtask).margin_rad, -0.1) << "else there would be nothing to show";
}

}  // namespace
}  // namespace armada
