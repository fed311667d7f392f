#include "hil/leader_path.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

namespace armada {
namespace {

constexpr int kMaxLaps = 10000;

// Shortest time that holds a whole number of every sine's periods.
double CommonPeriod(const std::vector<SineAxisConfig>& axes) {
  double slowest_hz = std::numeric_limits<double>::infinity();
  const auto moves = [](const SineAxisConfig& axis) {
    return axis.amplitude_m > 0.0 && axis.frequency_hz > 0.0;
  };
  for (const SineAxisConfig& axis : axes) {
    if (moves(axis)) slowest_hz = std::min(slowest_hz, axis.frequency_hz);
  }
  if (std::isinf(slowest_hz)) return 0.0;
  for (int laps = 1; laps <= kMaxLaps; ++laps) {
    const bool common = std::all_of(axes.begin(), axes.end(), [&](const SineAxisConfig& axis) {
      const double turns = laps * axis.frequency_hz / slowest_hz;
      return !moves(axis) || std::abs(turns - std::round(turns)) < 1e-9 * turns;
    });
    if (common) return laps / slowest_hz;
  }
  return std::numeric_limits<double>::infinity();
}

TaskVector ToVector(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

}  // namespace

LeaderPath::LeaderPath(const LeaderConfig& config) : kind_(config.kind) {
  if (kind_ == LeaderKind::kSine) AddAxes(config);
  if (kind_ == LeaderKind::kWaypoints) AddLegs(config);
}

void LeaderPath::AddAxes(const LeaderConfig& config) {
  assert(!config.axes.empty() && config.axes.size() <= size_t{kMaxTaskDim});
  for (const SineAxisConfig& axis : config.axes) {
    const double omega_rad_s = 2.0 * std::numbers::pi * axis.frequency_hz;
    axes_.push_back({axis.offset_m, axis.amplitude_m, omega_rad_s, axis.phase_rad});
  }
  period_s_ = CommonPeriod(config.axes);
}

void LeaderPath::AddLegs(const LeaderConfig& config) {
  const auto& points = config.waypoints_m;
  assert(!points.empty());
  loop_ = config.loop;
  const SCurveLimits limits{config.speed_m_s, config.acceleration_m_s2, config.jerk_m_s3};
  // A path that ends gets a last leg of no length, so that it rests in its last point as it does in the
  // others.
  for (size_t i = 0; i < points.size(); ++i) {
    const bool last = i + 1 == points.size();
    const TaskVector from_m = ToVector(points[i]);
    const TaskVector way_m =
        last && !loop_ ? TaskVector(0.0 * from_m) : TaskVector(ToVector(points[last ? 0 : i + 1]) - from_m);
    const double length_m = way_m.norm();
    const TaskVector direction = length_m > 0.0 ? TaskVector(way_m / length_m) : way_m;
    legs_.push_back({period_s_ + config.dwell_s, from_m, direction, SCurve(length_m, limits)});
    period_s_ = legs_.back().departure_s + legs_.back().motion.duration_s();
  }
  if (!loop_) period_s_ -= config.dwell_s;
  const bool moves =
      std::any_of(legs_.begin(), legs_.end(), [](const Leg& leg) { return leg.motion.length_m() > 0.0; });
  if (!moves) period_s_ = 0.0;
}

Zeta LeaderPath::At(double t_s) const {
  assert(kind_ != LeaderKind::kNone);
  if (kind_ == LeaderKind::kSine) return AtOnSine(t_s);
  const auto [leg, state] = OnLegs(t_s);
  return {leg->from_m + state.s_m * leg->direction, state.v_m_s * leg->direction,
          state.a_m_s2 * leg->direction};
}

TaskVector LeaderPath::Jerk(double t_s) const {
  assert(kind_ != LeaderKind::kNone);
  if (kind_ == LeaderKind::kWaypoints) {
    const auto [leg, state] = OnLegs(t_s);
    return state.jerk_m_s3 * leg->direction;
  }
  TaskVector jerk_m_s3(static_cast<Eigen::Index>(axes_.size()));
  std::transform(axes_.begin(), axes_.end(), jerk_m_s3.begin(), [&](const Axis& axis) {
    const double w = axis.omega_rad_s;
    return -axis.amplitude_m * w * w * w * std::cos(w * t_s + axis.phase_rad);
  });
  return jerk_m_s3;
}

Zeta LeaderPath::AtOnSine(double t_s) const {
  const auto task_dim = static_cast<Eigen::Index>(axes_.size());
  Zeta zeta{TaskVector(task_dim), TaskVector(task_dim), TaskVector(task_dim)};
  for (Eigen::Index c = 0; c < task_dim; ++c) {
    const Axis& axis = axes_[static_cast<size_t>(c)];
    const double w = axis.omega_rad_s;
    const double angle_rad = w * t_s + axis.phase_rad;
    const double swing_m = axis.amplitude_m * std::sin(angle_rad);
    zeta.x_m[c] = axis.offset_m + swing_m;
    zeta.v_m_s[c] = axis.amplitude_m * w * std::cos(angle_rad);
    zeta.a_m_s2[c] = -w * w * swing_m;
  }
  return zeta;
}

std::pair<const LeaderPath::Leg*, SCurve::State> LeaderPath::OnLegs(double t_s) const {
  const double lap_s = loop_ && period_s_ > 0.0 && t_s > 0.0 ? std::fmod(t_s, period_s_) : t_s;
  const auto next = std::upper_bound(legs_.begin(), legs_.end(), lap_s,
                                     [](double t, const Leg& leg) { return t < leg.departure_s; });
  // Before the first departure the first leg is at its start, by the SCurve itself; while resting, the leg
  // before is at its end.
  const Leg& leg = next == legs_.begin() ? legs_.front() : *(next - 1);
  return {&leg, leg.motion.At(lap_s - leg.departure_s)};
}

LeaderBounds LeaderPath::Bounds() const {
  LeaderBounds bounds;
  const auto widen = [&](double v, double a, double jerk, double snap) {
    bounds.v_m_s = std::max(bounds.v_m_s, v);
    bounds.a_m_s2 = std::max(bounds.a_m_s2, a);
    bounds.jerk_m_s3 = std::max(bounds.jerk_m_s3, jerk);
    bounds.snap_m_s4 = std::max(bounds.snap_m_s4, snap);
  };
  for (const Axis& axis : axes_) {
    const double w = axis.omega_rad_s;
    const double speed = axis.amplitude_m * w;
    widen(speed, speed * w, speed * w * w, speed * w * w * w);
  }
  for (const Leg& leg : legs_) {
    const double share =
        leg.direction.cwiseAbs().maxCoeff();  // of the motion, on the axis that has most of it
    const double jerk = share * leg.motion.peak_jerk_m_s3();
    widen(share * leg.motion.peak_speed_m_s(), share * leg.motion.peak_acceleration_m_s2(), jerk,
          jerk > 0.0 ? std::numeric_limits<double>::infinity() : 0.0);
  }
  return bounds;
}

}  // namespace armada
