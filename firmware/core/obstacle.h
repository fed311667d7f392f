#pragma once

#include "firmware/core/parameter.h"
#include "firmware/core/types.h"

namespace armada {

inline constexpr int kMaxObstacles = 8;

enum class ObstacleKind {
  kDisc,       ///< all within radius_m of a point
  kHalfPlane,  ///< all behind a straight edge: a wall, a table
};

constexpr auto EnumNames(ObstacleKind) {
  using enum ObstacleKind;
  return std::to_array<EnumName<ObstacleKind>>({{kDisc, "disc"}, {kHalfPlane, "half_plane"}});
}

/// A thing at rest in the plane in which a planar arm moves, in the fleet's world frame.
struct ObstacleConfig {
  ObstacleKind kind = ObstacleKind::kDisc;
  double x_m = 0.0;  ///< disc: its centre; half-plane: a point of its edge
  double y_m = 0.0;
  double radius_m = 0.1;
  double normal_rad = 0.0;

  void Visit(ParameterVisitor& parameter) {
    parameter({"kind", "", 0, 0, "disc, or half_plane: everything behind a straight edge"}, kind);
    parameter({"x_m", "m", -1e3, 1e3, "disc: x of its centre; half_plane: x of a point of its edge"}, x_m);
    parameter({"y_m", "m", -1e3, 1e3, "the same for y"}, y_m);
    parameter({"radius_m", "m", 0, 1e3, "disc: its radius"}, radius_m);
    parameter({"normal_rad", "rad", -7, 7,
               "half_plane: direction from its edge into the free space, from the world's x axis"},
              normal_rad);
  }
};

/// Of a straight link and an obstacle: how far apart, and where.
struct Separation {
  double distance_m = 0.0;                               ///< negative inside the obstacle
  double fraction = 0.0;                                 ///< place on the link: 0 at its start, 1 at its end
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  ///< away from the obstacle, of length 1
};

/// The point of the link from `start` to `end` that is nearest to a disc's centre. Of a half-plane always the
/// link's end: the nearest point of an arm is a joint or the tip, and each is the end of some link but the
/// base.
Separation SeparationOf(const ObstacleConfig& obstacle, const Eigen::Vector2d& start,
                        const Eigen::Vector2d& end);

}  // namespace armada
