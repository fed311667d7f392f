#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace armada {

/// Counts in bins of one width on a logarithmic scale. The bins are the same for every sweep and every
/// figure, so the histogram of a whole is the sum of its parts'.
class LogHistogram {
 public:
  static constexpr int kBinsPerDecade = 100;
  static constexpr int kDecades = 9;  ///< to either side of 1; what lies beyond counts in the last bin

  LogHistogram() : counts_(size_t{2} * kDecades * kBinsPerDecade) {}

  void Add(double value) { ++counts_[IndexOf(value)]; }

  /// {"first_bin": b, "counts": [..]}: bin b + i, from 10^((b + i)/100) to 10^((b + i + 1)/100), holds
  /// counts[i]. From the first to the last that holds anything.
  nlohmann::ordered_json ToJson() const;

 private:
  static size_t IndexOf(double value);

  std::vector<int64_t> counts_;
};

}  // namespace armada
