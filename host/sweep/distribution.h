#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "host/sweep/log_histogram.h"

namespace armada {

/// Median and tails of one figure over the seeds; percentiles are the nearest rank.
struct Distribution {
  int64_t count = 0;  ///< seeds in it; without one the rest means nothing
  double median = 0.0;
  double p95 = 0.0;
  double p99 = 0.0;
  double p999 = 0.0;
  double max = 0.0;
  uint64_t worst_seed = 0;  ///< which seed gave the maximum, the last of equals
  LogHistogram histogram;
};

nlohmann::ordered_json ToJson(const Distribution& distribution);

/// The `rank`-th smallest, from 1, of the numbers that `for_each(visit)` visits, none below 0. In constant
/// memory, by visiting them four times: such numbers are ordered as their bits are, of which each visit finds
/// sixteen.
/// @pre there are at least `rank`.
template <class ForEach>
double NearestRank(const ForEach& for_each, int64_t rank) {
  constexpr int kDigitBits = 16;
  std::vector<int64_t> counts;
  uint64_t found = 0;  // leading digits of the result
  for (int digit_shift = 64 - kDigitBits; digit_shift >= 0; digit_shift -= kDigitBits) {
    counts.assign(size_t{1} << kDigitBits, 0);
    for_each([&](double value) {
      const uint64_t digits = std::bit_cast<uint64_t>(value) >> digit_shift;
      if (digits >> kDigitBits == found) ++counts[digits & ((1u << kDigitBits) - 1)];
    });
    size_t digit = 0;
    while (rank > counts[digit]) rank -= counts[digit++];
    found = found << kDigitBits | digit;
  }
  return std::bit_cast<double>(found);
}

/// Distribution of `value_of(row)` over the rows below `rows`, a seed each; a NaN is not in it.
template <class ValueOf, class SeedOf>
Distribution DistributionOf(size_t rows, const ValueOf& value_of, const SeedOf& seed_of) {
  Distribution result;
  for (size_t row = 0; row < rows; ++row) {
    const double value = value_of(row);
    if (std::isnan(value)) continue;
    ++result.count;
    result.histogram.Add(value);
    if (value < result.max) continue;
    result.max = value;
    result.worst_seed = seed_of(row);
  }
  if (result.count == 0) return result;
  const auto for_each = [&](const auto& visit) {
    for (size_t row = 0; row < rows; ++row) {
      if (const double value = value_of(row); !std::isnan(value)) visit(value);
    }
  };
  const auto at = [&](double share) {
    const auto rank = static_cast<int64_t>(std::ceil(share * static_cast<double>(result.count)));
    return NearestRank(for_each, std::max<int64_t>(rank, 1));
  };
  result.median = at(0.5);
  result.p95 = at(0.95);
  result.p99 = at(0.99);
  result.p999 = at(0.999);
  return result;
}

}  // namespace armada
