#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace armada {

/// Durations counted in bins of 1 us up to 20 ms, without a heap: percentiles of a whole run. Longer ones
/// share the last bin; the maximum is exact.
class DurationHistogram {
 public:
  void Add(int64_t duration_ns) {
    const int64_t us = std::clamp<int64_t>(duration_ns / 1000, 0, kBins - 1);
    ++counts_[static_cast<size_t>(us)];
    ++total_;
    max_ns_ = std::max(max_ns_, duration_ns);
  }

  int64_t count() const { return total_; }
  double max_us() const { return 1e-3 * static_cast<double>(max_ns_); }
  /// Smallest bin that at least `share` of the durations do not exceed, us; 0 without any.
  double PercentileUs(double share) const {
    int64_t seen = 0;
    for (size_t bin = 0; bin < counts_.size(); ++bin) {
      seen += counts_[bin];
      if (seen > 0 && static_cast<double>(seen) >= share * static_cast<double>(total_)) {
        return static_cast<double>(bin);
      }
    }
    return 0.0;
  }

 private:
  static constexpr int64_t kBins = 20'000;
  std::array<uint32_t, kBins> counts_{};
  int64_t total_ = 0;
  int64_t max_ns_ = 0;
};

}  // namespace armada
