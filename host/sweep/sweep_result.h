#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host/metrics.h"

namespace armada {

/// What a sweep keeps of one seed.
struct SeedResult {
  struct Arm {
    int id = 0;
    bool diverged = false;
    std::optional<double> settled_s;
    double rms_mm = 0.0;
    double max_mm = 0.0;
    double estimator_x_m = 0.0;
    std::optional<double> floor_rms_mm;  ///< with `armada sweep --floor`
  };
  uint64_t seed = 0;
  bool ok = false;
  double fleet_rms_mm = 0.0;
  std::optional<double> floor_rms_mm;  ///< of the fleet, as of its arms
  std::vector<Arm> arms;

  static SeedResult Of(const RunMetrics& metrics);
};

/// Median and tails of one figure over the seeds.
struct Distribution {
  int64_t count = 0;  ///< seeds in it; without one the rest means nothing
  double median = 0.0;
  double p95 = 0.0;
  double p999 = 0.0;
  double max = 0.0;
  uint64_t worst_seed = 0;  ///< which seed gave the maximum
};

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

struct SweepSummary {
  int64_t count = 0;
  int64_t ok_count = 0;
  bool has_floors = false;  ///< of `armada sweep --floor`
  std::optional<double>
      fleet_rms_mm;  ///< root of the mean square over the fleets that are ok; none without one
  std::optional<double> floor_rms_mm;  ///< of the floors of those fleets
  Distribution fleet_rms_all_mm;       ///< fleet RMS of every fleet, ok or not
  double estimator_rms_x_m = 0.0;      ///< the same over all fleets and arms
  std::vector<SweepArmSummary> arms;
  std::vector<uint64_t> failed_seeds;
};

struct Sweep {
  std::string scenario;
  std::vector<std::string> overrides;
  std::vector<SeedResult> runs;  ///< ascending by seed
};

SweepSummary Summarize(const std::vector<SeedResult>& runs);

nlohmann::ordered_json ToJson(const Sweep& sweep);
/// Reads what ToJson wrote. Nothing with *error set when it is something else.
std::optional<Sweep> SweepFromJson(const nlohmann::ordered_json& json, std::string* error);

/// One sweep of several shards. Nothing with *error set when they are of different scenarios or settings,
/// with and without floors, or share a seed.
std::optional<Sweep> Merge(const std::vector<Sweep>& shards, std::string* error);

}  // namespace armada
