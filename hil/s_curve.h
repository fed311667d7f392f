#pragma once

namespace armada {

/// Bounds on the motion along a line; all > 0.
struct SCurveLimits {
  double speed_m_s = 0.0;
  double acceleration_m_s2 = 0.0;
  double jerk_m_s3 = 0.0;
};

/// Fastest motion from rest to rest over a given length under bounds on speed, acceleration and jerk: up to
/// seven phases of constant jerk (+ 0 - 0 - 0 +). A length too short for a bound to be reached leaves the
/// phase out that would hold it.
class SCurve {
 public:
  struct State {
    double s_m = 0.0;
    double v_m_s = 0.0;
    double a_m_s2 = 0.0;
    double jerk_m_s3 = 0.0;  ///< where it jumps: either value
  };

  SCurve(double length_m, const SCurveLimits& limits);

  /// At rest at 0 before the motion and at `length_m` after it.
  State At(double t_s) const;

  double length_m() const { return length_m_; }
  double duration_s() const { return 2.0 * ramp_s_ + cruise_s_; }
  /// Largest values that occur; those of a motion of no length are zero.
  double peak_speed_m_s() const { return peak_speed_m_s_; }
  double peak_acceleration_m_s2() const { return jerk_m_s3_ * jerk_time_s_; }
  double peak_jerk_m_s3() const { return length_m_ > 0.0 ? jerk_m_s3_ : 0.0; }

 private:
  State FirstHalf(double t_s) const;

  double length_m_;
  double jerk_m_s3_;
  double jerk_time_s_ = 0.0;  ///< of each of the four phases with jerk
  double ramp_s_ = 0.0;       ///< from rest to the peak speed
  double cruise_s_ = 0.0;     ///< at the peak speed
  double peak_speed_m_s_ = 0.0;
};

}  // namespace armada
