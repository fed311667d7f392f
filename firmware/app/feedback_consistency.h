#pragma once

#include <cmath>

namespace armada {

/// Notices a joint whose position and speed do not belong together: one of them stuck, off, or of somebody
/// else. What the position moves beyond the integral of the speed is summed up and forgotten over `memory_s`.
class FeedbackConsistency {
 public:
  struct Limits {
    double travel_max_rad;     ///< most that may stand in the sum
    double speed_noise_rad_s;  ///< of a speed, and what of noise is allowed in the sum
    double memory_s;
  };

  explicit FeedbackConsistency(const Limits& limits) : limits_(limits) {}

  /// Takes the sample that comes `elapsed_s` after the last one. True when the two contradict each other.
  bool Update(double position_rad, double velocity_rad_s, double elapsed_s) {
    if (std::isfinite(position_rad_) && elapsed_s > 0.0) {
      const double moved_rad = position_rad - position_rad_;
      const double expected_rad = 0.5 * (velocity_rad_s_ + velocity_rad_s) * elapsed_s;
      const double kept = std::exp(-elapsed_s / limits_.memory_s);
      beyond_rad_ = kept * beyond_rad_ + moved_rad - expected_rad;
      // Independent noise of the speeds: a variance of (s h)^2 a sample over memory / 2 h samples.
      const double noise_rad = limits_.speed_noise_rad_s * std::sqrt(0.5 * elapsed_s * limits_.memory_s);
      allowed_rad_ = limits_.travel_max_rad + noise_rad;
    }
    position_rad_ = position_rad;
    velocity_rad_s_ = velocity_rad_s;
    return std::abs(beyond_rad_) > allowed_rad_;
  }

 private:
  Limits limits_;
  double position_rad_ = std::nan("");
  double velocity_rad_s_ = 0.0;
  double beyond_rad_ = 0.0;
  double allowed_rad_ = limits_.travel_max_rad;
};

}  // namespace armada
