#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "hil/scenario.h"

namespace armada {

/// Errors of one arm's end effector, sampled at 1 kHz of plant time: what `metrics.json` says of an arm's
/// motion.
class TrackingRecord {
 public:
  static constexpr double kSamplePeriod_s = 0.001;

  explicit TrackingRecord(const ScenarioConfig& scenario)
      : window_start_s_(scenario.window_start_s), band_m_(scenario.criterion.error_max_m) {}

  void Update(double t_s, double error_m) {
    if (error_m >= band_m_) {
      settled_s_.reset();
    } else if (!settled_s_) {
      settled_s_ = t_s;
    }
    if (t_s < window_start_s_) return;
    sum_squares_m2_ += error_m * error_m;
    if (!max_at_s_ || error_m > max_m_) {
      max_m_ = error_m;
      max_at_s_ = t_s;
    }
    if (error_m >= band_m_ && !beyond_at_s_) beyond_at_s_ = t_s;
    ++count_;
  }

  double rms_m() const { return count_ > 0 ? std::sqrt(sum_squares_m2_ / static_cast<double>(count_)) : 0.0; }
  double max_m() const { return max_m_; }
  /// When it was max_m(); none before the window.
  std::optional<double> max_at_s() const { return max_at_s_; }
  /// First time in the window at which the error was not inside the criterion's band.
  std::optional<double> beyond_at_s() const { return beyond_at_s_; }
  int64_t count() const { return count_; }
  double sum_squares_m2() const { return sum_squares_m2_; }
  /// First time after which the error stayed inside the criterion's band.
  std::optional<double> settled_s() const { return settled_s_; }

 private:
  double window_start_s_;
  double band_m_;
  std::optional<double> settled_s_;
  double sum_squares_m2_ = 0.0;
  double max_m_ = 0.0;
  std::optional<double> max_at_s_;
  std::optional<double> beyond_at_s_;
  int64_t count_ = 0;
};

}  // namespace armada
