#include "host/sweep/log_histogram.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace armada {

size_t LogHistogram::IndexOf(double value) {
  constexpr double kBins = kDecades * kBinsPerDecade;  // to either side of 1
  const double bin = value > 0.0 ? std::floor(kBinsPerDecade * std::log10(value)) : -kBins;
  return static_cast<size_t>(std::clamp(bin, -kBins, kBins - 1.0) + kBins);
}

nlohmann::ordered_json LogHistogram::ToJson() const {
  const auto used = [](int64_t count) { return count > 0; };
  const auto first = std::find_if(counts_.begin(), counts_.end(), used);
  const auto end = std::find_if(counts_.rbegin(), std::make_reverse_iterator(first), used).base();
  const auto first_bin = static_cast<int>(first - counts_.begin()) - kDecades * kBinsPerDecade;
  return {{"first_bin", first == end ? 0 : first_bin}, {"counts", std::vector<int64_t>(first, end)}};
}

}  // namespace armada
