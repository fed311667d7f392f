#pragma once

#include <utility>
#include <vector>

#include "firmware/core/zeta.h"
#include "hil/s_curve.h"
#include "hil/scenario.h"

namespace armada {

/// What Assumption (A2) bounds: suprema over time of the infinity norms.
struct LeaderBounds {
  double v_m_s = 0.0;
  double a_m_s2 = 0.0;
  double jerk_m_s3 = 0.0;
  double snap_m_s4 =
      0.0;  ///< d jerk/dt; infinite where the jerk jumps. (A2) does not need it, predictions do
};

/// The leader's state zeta_0(t) = col(x_0, v_0, a_0), exact at any time, t = 0 being the fleet's start.
///   sine       x_0 = offset + amplitude sin(2 pi frequency t + phase) on each axis, before t = 0 too;
///   waypoints  straight from each to the next as an SCurve, after `dwell_s` at rest; at the first before t =
///   0. Without
///              `loop` the last is the end, with it the way leads back to the first.
class LeaderPath {
 public:
  /// @pre sine: one axis a task dimension; waypoints: at least one, all of the task's dimension.
  explicit LeaderPath(const LeaderConfig& config);

  /// @pre the kind is not none. Allocates nothing.
  Zeta At(double t_s) const;

  /// da_0/dt. @pre as for At. Allocates nothing.
  TaskVector Jerk(double t_s) const;

  /// Exact, and attained. Zero where there is no leader: the point on which a leaderless fleet agrees is at
  /// rest.
  LeaderBounds Bounds() const;

  /// Time after which nothing new comes: of one lap of a path that repeats, else to its end. 0 at rest,
  /// infinite for sines without a common period.
  double period_s() const { return period_s_; }

 private:
  struct Axis {
    double offset_m, amplitude_m, omega_rad_s, phase_rad;
  };
  struct Leg {
    double departure_s;  ///< time of a lap at which the way to the next waypoint begins
    TaskVector from_m;
    TaskVector direction;
    SCurve motion;
  };
  void AddAxes(const LeaderConfig& config);
  void AddLegs(const LeaderConfig& config);
  Zeta AtOnSine(double t_s) const;
  /// The leg under way and where along it the leader is.
  std::pair<const Leg*, SCurve::State> OnLegs(double t_s) const;

  LeaderKind kind_;
  bool loop_ = false;
  double period_s_ = 0.0;
  std::vector<Axis> axes_;
  std::vector<Leg> legs_;
};

}  // namespace armada
