#include "firmware/core/obstacle.h"

#include <algorithm>
#include <cmath>

namespace armada {

Separation SeparationOf(const ObstacleConfig& obstacle, const Eigen::Vector2d& start,
                        const Eigen::Vector2d& end) {
  const Eigen::Vector2d place(obstacle.x_m, obstacle.y_m);
  if (obstacle.kind == ObstacleKind::kHalfPlane) {
    const Eigen::Vector2d normal(std::cos(obstacle.normal_rad), std::sin(obstacle.normal_rad));
    return {normal.dot(end - place), 1.0, normal};
  }
  const Eigen::Vector2d along = end - start;
  const double fraction = std::clamp(along.dot(place - start) / along.squaredNorm(), 0.0, 1.0);
  const Eigen::Vector2d apart = start + fraction * along - place;
  const double distance_m = apart.norm();
  // A link through the very centre leaves sideways.
  const Eigen::Vector2d direction = distance_m > 1e-9 ? Eigen::Vector2d(apart / distance_m)
                                                      : Eigen::Vector2d(-along[1], along[0]).normalized();
  return {distance_m - obstacle.radius_m, fraction, direction};
}

}  // namespace armada
