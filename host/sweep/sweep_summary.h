#pragma once

#include <optional>
#include <vector>

#include "host/sweep/distribution.h"
#include "host/sweep/result_table.h"

namespace armada {

struct SweepArmSummary {
  int id = 0;
  int64_t diverged = 0;
  int64_t never_settled = 0;
  Distribution rms_mm;  ///< of the seeds in which the arm did not diverge
  Distribution max_mm;
  Distribution settled_s;  ///< of those in which it settled
  Distribution floor_mm;   ///< of those that have a floor and in which the arm did not diverge
  Distribution over_floor;
};

/// A seed that is worth looking at, and the arm that makes it so.
struct WorstSeed {
  uint64_t seed = 0;
  int arm = 0;
  double value = 0.0;
};

/// The worst fleets by one figure, the worst first. Fleets with a diverged arm are not in it: they are not
/// ok.
class WorstSeeds {
 public:
  static constexpr size_t kCount = 5;

  void Add(const WorstSeed& seed);
  const std::vector<WorstSeed>& list() const { return list_; }

 private:
  std::vector<WorstSeed> list_;
};

struct SweepSummary {
  static constexpr size_t kFailedSeedsListed = 1000;

  int64_t count = 0;
  int64_t ok_count = 0;
  std::vector<uint64_t> failed_seeds;  ///< that are not ok: the first of them
  std::optional<double>
      fleet_rms_mm;  ///< root of the mean square over the fleets that are ok; none without one
  bool has_floors = false;
  std::optional<double> floor_rms_mm;  ///< the same of the floors of those fleets
  double estimator_rms_x_m = 0.0;      ///< the same over all fleets and arms
  Distribution fleet_rms_all_mm;       ///< fleet RMS of every fleet, ok or not
  Distribution fleet_over_floor;       ///< RMS by its floor, of the fleets in which no arm diverged
  Distribution fleet_max_mm;           ///< largest error of any arm, of the fleets in which none diverged
  Distribution fleet_settled_s;        ///< time when the last arm has settled, of the fleets in which all do
  std::vector<SweepArmSummary> arms;
  WorstSeeds worst_settled_s;  ///< by the arm that settles last
  WorstSeeds worst_rms_mm;     ///< by the fleet's RMS; the arm has the largest of its own
  WorstSeeds worst_max_mm;     ///< by the largest error of any arm

  int64_t failed_count() const { return count - ok_count; }
};

/// Needs no more memory for many seeds than for few. Rows ascend by seed.
SweepSummary Summarize(const ResultTable& results);

}  // namespace armada
