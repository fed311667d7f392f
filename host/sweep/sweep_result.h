#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host/sweep/result_table.h"
#include "host/sweep/sweep_summary.h"

namespace armada {

/// One scenario over many seeds.
struct Sweep {
  std::string scenario;
  std::string scenario_file;
  std::vector<std::string> overrides;
  ResultTable results;  ///< ascending by seed
};

/// The command line that runs a seed of the sweep again, quoted for a shell; the seed itself is to follow.
std::string ReplayCommand(const Sweep& sweep);
/// The same with its seed.
std::string ReplayCommand(const Sweep& sweep, uint64_t seed);

/// What the sweep's JSON (docs/metrics.md) says before `runs`.
nlohmann::ordered_json HeaderJson(const Sweep& sweep, const SweepSummary& summary);

/// Writes the sweep's JSON, a line a seed. False with *error set when it cannot be written.
bool WriteSweep(const Sweep& sweep, const SweepSummary& summary, const std::string& path, std::string* error);

/// Reads what WriteSweep wrote. Nothing with *error set when it is something else.
std::optional<Sweep> ReadSweep(const std::string& path, std::string* error);

/// One sweep of several shards. Nothing with *error set when they are of different scenarios or settings,
/// with and without floors, or share a seed.
std::optional<Sweep> Merge(const std::vector<Sweep>& shards, std::string* error);

}  // namespace armada
