#include "firmware/core/avoidance.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "firmware/core/obstacle.h"

namespace armada {
namespace {

constexpr int kMaxBarriers = 2 * kMaxDof + kMaxDof * kMaxObstacles;

/// Distances d_k(q) and their gradients.
struct Barriers {
  BoundedVector<kMaxBarriers> distance;
  BoundedMatrix<kMaxDof, kMaxBarriers> gradient;  ///< a column each
};

/// Calls `visit(link, joints, separation)` for each pair of link, from 0, and obstacle; `joints` are the
/// places of the joints, and last of the tip.
template <class Visit>
void ForEachSeparation(const PlanarArm& arm, const PlanarArm::Posture& at, Visit visit) {
  std::array<Eigen::Vector2d, kMaxDof + 1> joints;
  joints[0] << arm.config().base_x_m, arm.config().base_y_m;
  for (int i = 0; i < arm.dof(); ++i) {
    const auto link = static_cast<size_t>(i);
    joints[link + 1] =
        joints[link] + arm.config().links[link].l_m * Eigen::Vector2d(at.cosine[i], at.sine[i]);
    for (int k = 0; k < arm.config().obstacle_count; ++k) {
      visit(i, joints,
            SeparationOf(arm.config().obstacles[static_cast<size_t>(k)], joints[link], joints[link + 1]));
    }
  }
}

/// Calls `visit(joint, sign, distance)` for each limit: sign 1 for a lower, -1 for an upper one.
template <class Visit>
void ForEachLimit(const PlanarArmConfig& arm, const JointVector& q, Visit visit) {
  for (Eigen::Index j = 0; j < arm.q_min_rad.size(); ++j) visit(j, 1.0, q[j] - arm.q_min_rad[j]);
  for (Eigen::Index j = 0; j < arm.q_max_rad.size(); ++j) visit(j, -1.0, arm.q_max_rad[j] - q[j]);
}

Barriers BarriersOf(const AvoidanceConfig& config, const PlanarArm& arm, const JointVector& q,
                    const PlanarArm::Posture& at) {
  const Eigen::Index pairs = Eigen::Index{arm.dof()} * arm.config().obstacle_count;
  const Eigen::Index count = arm.config().q_min_rad.size() + arm.config().q_max_rad.size() + pairs;
  Barriers barriers{BoundedVector<kMaxBarriers>(count),
                    BoundedMatrix<kMaxDof, kMaxBarriers>::Zero(arm.dof(), count)};
  Eigen::Index next = 0;
  ForEachLimit(arm.config(), q, [&](Eigen::Index joint, double sign, double distance_rad) {
    barriers.distance[next] = distance_rad - config.joint_margin_rad;
    barriers.gradient(joint, next++) = sign;
  });
  ForEachSeparation(arm, at, [&](int link, const auto& joints, const Separation& apart) {
    const auto i = static_cast<size_t>(link);
    const Eigen::Vector2d nearest = joints[i] + apart.fraction * (joints[i + 1] - joints[i]);
    barriers.distance[next] = apart.distance_m - config.clearance_m;
    for (int k = 0; k <= link; ++k) {  // the joints before the point turn it about themselves
      const Eigen::Vector2d arm_of_k = nearest - joints[static_cast<size_t>(k)];
      barriers.gradient(k, next) = apart.direction[1] * arm_of_k[0] - apart.direction[0] * arm_of_k[1];
    }
    ++next;
  });
  return barriers;
}

/// The barriers as springs on one side: all that the argmin is about.
struct Springs {
  const BoundedMatrix<kMaxDof, kMaxBarriers>& rows;  ///< a column each: (I - J#J)' of a barrier's gradient
  const BoundedVector<kMaxBarriers>& least;          ///< what its product with phi should be at least
  const JointVector& wanted;
  double weight;

  double Shortfall(Eigen::Index k, const JointVector& phi) const {
    return std::max(0.0, least[k] - rows.col(k).dot(phi));
  }
  double Cost(const JointVector& phi) const {
    double cost = 0.5 * (phi - wanted).squaredNorm();
    for (Eigen::Index k = 0; k < least.size(); ++k) {
      const double shortfall = Shortfall(k, phi);
      cost += 0.5 * weight * shortfall * shortfall;
    }
    return cost;
  }
  JointVector NewtonStep(const JointVector& phi) const {
    JointVector descent = wanted - phi;
    JointMatrix curvature = JointMatrix::Identity(phi.size(), phi.size());
    for (Eigen::Index k = 0; k < least.size(); ++k) {
      const double shortfall = Shortfall(k, phi);
      if (shortfall <= 0.0) continue;
      descent += (weight * shortfall) * rows.col(k);
      curvature += weight * rows.col(k).lazyProduct(rows.col(k).transpose());
    }
    return curvature.llt().solve(descent);
  }
};

/// Convex and piecewise quadratic: Newton's steps end at the minimum as soon as they no longer change which
/// springs act, mostly after two.
JointVector Minimize(const AvoidanceConfig& config, const Springs& springs) {
  JointVector phi = springs.wanted;
  double cost = springs.Cost(phi);
  for (int i = 0; i < config.steps; ++i) {
    JointVector step = springs.NewtonStep(phi);
    if (!(step.cwiseAbs().maxCoeff() > config.tolerance_rad_s)) break;
    for (int halving = 0; halving < config.halvings && springs.Cost(phi + step) > cost; ++halving)
      step *= 0.5;
    phi += step;
    cost = springs.Cost(phi);
  }
  return phi;
}

}  // namespace

bool HasBarriers(const PlanarArmConfig& arm) {
  return arm.q_min_rad.size() > 0 || arm.q_max_rad.size() > 0 || arm.obstacle_count > 0;
}

JointVector Avoid(const AvoidanceConfig& config, const PlanarArm& arm, const JointVector& q,
                  const PlanarArm::Posture& at, const JointMatrix& null_space, const JointVector& dq_main,
                  const JointVector& wanted) {
  const Barriers barriers = BarriersOf(config, arm, q, at);
  const BoundedMatrix<kMaxDof, kMaxBarriers> rows = null_space.transpose().lazyProduct(barriers.gradient);
  const BoundedVector<kMaxBarriers> least =
      -config.rate_1_s * barriers.distance - barriers.gradient.transpose().lazyProduct(dq_main);
  JointVector phi = Minimize(config, {rows, least, wanted, config.weight});
  const double largest = phi.cwiseAbs().maxCoeff();
  if (largest > config.phi_max_rad_s) phi *= config.phi_max_rad_s / largest;
  return phi;
}

double ClearanceOf(const PlanarArm& arm, const JointVector& q) {
  double least_m = std::numeric_limits<double>::infinity();
  ForEachSeparation(arm, arm.At(q), [&](int, const auto&, const Separation& apart) {
    least_m = std::min(least_m, apart.distance_m);
  });
  return least_m;
}

double LimitMarginOf(const PlanarArm& arm, const JointVector& q) {
  double least_rad = std::numeric_limits<double>::infinity();
  ForEachLimit(arm.config(), q, [&](Eigen::Index, double, double distance_rad) {
    least_rad = std::min(least_rad, distance_rad);
  });
  return least_rad;
}

}  // namespace armada
