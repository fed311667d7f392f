#include "hil/s_curve.h"

#include <algorithm>
#include <cmath>

namespace armada {

// With V, A, J the peaks, a ramp from rest to V takes 2 A/J where A is just touched and V/A + A/J where it is
// held; the mean speed over it is V/2, so that two ramps cover V times the time of one.
SCurve::SCurve(double length_m, const SCurveLimits& limits)
    : length_m_(length_m), jerk_m_s3_(limits.jerk_m_s3) {
  if (length_m_ <= 0.0) return;
  const double J = limits.jerk_m_s3;
  const double A = limits.acceleration_m_s2;
  const double touch_speed_m_s = A * A / J;  // the lowest peak speed at which A is reached
  const auto ramp_s = [&](double V) { return V < touch_speed_m_s ? 2.0 * std::sqrt(V / J) : V / A + A / J; };

  peak_speed_m_s_ = limits.speed_m_s;
  if (length_m_ < peak_speed_m_s_ * ramp_s(peak_speed_m_s_)) {  // too short for the speed: length = V ramp(V)
    const bool touches = length_m_ >= touch_speed_m_s * ramp_s(touch_speed_m_s);
    peak_speed_m_s_ = touches ? 0.5 * A * (std::sqrt(A * A / (J * J) + 4.0 * length_m_ / A) - A / J)
                              : J * std::pow(std::cbrt(length_m_ / (2.0 * J)), 2);
  }
  ramp_s_ = ramp_s(peak_speed_m_s_);
  jerk_time_s_ = peak_speed_m_s_ < touch_speed_m_s ? 0.5 * ramp_s_ : A / J;
  cruise_s_ = std::max(0.0, length_m_ / peak_speed_m_s_ - ramp_s_);
}

SCurve::State SCurve::At(double t_s) const {
  if (t_s <= 0.0) return {};
  const double left_s = duration_s() - t_s;
  if (left_s <= 0.0) return {length_m_, 0.0, 0.0, 0.0};
  if (t_s <= left_s) return FirstHalf(t_s);
  const State mirrored = FirstHalf(left_s);
  return {length_m_ - mirrored.s_m, mirrored.v_m_s, -mirrored.a_m_s2, mirrored.jerk_m_s3};
}

SCurve::State SCurve::FirstHalf(double t_s) const {
  const double J = jerk_m_s3_;
  if (t_s < jerk_time_s_) return {J * t_s * t_s * t_s / 6.0, 0.5 * J * t_s * t_s, J * t_s, J};

  const double to_cruise_s = ramp_s_ - t_s;
  if (to_cruise_s >= jerk_time_s_) {
    const double held_s = t_s - jerk_time_s_;
    const double A = J * jerk_time_s_;
    const double v = 0.5 * A * jerk_time_s_;
    return {v * jerk_time_s_ / 3.0 + v * held_s + 0.5 * A * held_s * held_s, v + A * held_s, A, 0.0};
  }
  const double V = peak_speed_m_s_;
  const double at_cruise_m = 0.5 * V * ramp_s_ - V * to_cruise_s;
  if (to_cruise_s <= 0.0) return {at_cruise_m, V, 0.0, 0.0};
  return {at_cruise_m + J * to_cruise_s * to_cruise_s * to_cruise_s / 6.0,
          V - 0.5 * J * to_cruise_s * to_cruise_s, J * to_cruise_s, -J};
}

}  // namespace armada
