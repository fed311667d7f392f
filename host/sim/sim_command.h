#pragma once

#include <cstdint>
#include <string>

#include "host/metrics.h"
#include "host/scenario_arguments.h"

namespace armada {

struct SimOptions {
  ScenarioArguments scenario;
  uint64_t seed = 1;
  std::string json;
  std::string trace;
  bool floor = false;  ///< the unavoidable error, too
};

/// `armada sim`: one scenario in virtual time. Exit code.
int RunSimCommand(const SimOptions& options);

/// Runs a scenario into a directory that `armada report` reads: traces, metrics.json, the effective
/// configuration and, in learned/, what the arms have learnt. With `floor` the metrics tell the unavoidable
/// error, too. False with *error set when a file cannot be written.
bool SimulateInto(const ScenarioConfig& scenario, uint64_t seed, const std::string& directory, bool floor,
                  RunMetrics* metrics, std::string* error);

}  // namespace armada
