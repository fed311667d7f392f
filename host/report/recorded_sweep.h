#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/report/recorded_run.h"

namespace armada {

/// One figure of merit of an arm, or of the fleet, over the seeds of a sweep.
struct SweepFigure {
  std::string of;              ///< "arm 3" or "fleet"
  Json distribution;           ///< as in docs/metrics.md; null over no seed
  int first_bin = 0;           ///< of the histogram
  std::vector<double> counts;  ///< of its bins

  int end_bin() const { return first_bin + static_cast<int>(counts.size()); }
  /// Seeds in bin `bin`, counted as the first bin is.
  double CountIn(int bin) const {
    return bin < first_bin || bin >= end_bin() ? 0.0 : counts[static_cast<size_t>(bin - first_bin)];
  }
};

/// What `armada sweep --json` wrote, without the results of single seeds.
struct RecordedSweep {
  Json summary;
  std::vector<int> arm_ids;
  double bins_per_decade = 0.0;
  double count = 0.0;  ///< seeds
  /// Of each arm, the fleet's last.
  std::vector<SweepFigure> settled_s, rms_mm, max_mm;
  std::vector<SweepFigure> over_floor;  ///< RMS by the unavoidable one; empty without `--floor`
};

/// Throws ReportError that names the file and what is missing or wrong.
RecordedSweep LoadRecordedSweep(const std::filesystem::path& path);

}  // namespace armada
