#pragma once

#include <string>
#include <vector>

#include "host/sweep/sweep_result.h"

namespace armada {

/// A made-up result of a fleet of one arm: settled after a tenth of its seed in seconds, unless it is not ok.
inline SeedResult ResultOf(uint64_t seed, double rms_mm, bool ok) {
  SeedResult result{seed, ok, rms_mm, std::nullopt, {}};
  result.arms.push_back({.id = 1,
                         .diverged = !ok,
                         .settled_s = std::nullopt,
                         .rms_mm = rms_mm,
                         .max_mm = 3.0 * rms_mm,
                         .estimator_x_m = 1e-5,
                         .floor_rms_mm = std::nullopt});
  if (ok) result.arms[0].settled_s = 0.1 * static_cast<double>(seed);
  return result;
}

inline Sweep SweepOf(const std::vector<SeedResult>& results) {
  Sweep sweep{"paper", "scenarios/paper.toml", {}, ResultTable(results.size(), {1})};
  for (size_t row = 0; row < results.size(); ++row) sweep.results.Set(row, results[row]);
  return sweep;
}

/// Seeds first, first + step, .. up to last, all ok, the RMS rising with the seed.
inline Sweep SweepOf(uint64_t first, uint64_t last, uint64_t step) {
  std::vector<SeedResult> results;
  for (uint64_t seed = first; seed <= last; seed += step)
    results.push_back(ResultOf(seed, 0.5 + 0.001 * static_cast<double>(seed), true));
  return SweepOf(results);
}

}  // namespace armada
