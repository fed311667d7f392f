#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "host/metrics.h"

namespace armada {

/// What a sweep keeps of one seed: an entry of `runs` in its JSON.
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

/// Ids of a fleet's arms, in its order: that of a result's.
std::vector<int> ArmIds(const ScenarioConfig& scenario);

nlohmann::ordered_json ToJson(const SeedResult& result);
/// Reads what ToJson wrote. Throws nlohmann::json::exception when it is something else.
SeedResult SeedResultFromJson(const nlohmann::ordered_json& json);

}  // namespace armada
