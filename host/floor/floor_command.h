#pragma once

#include <cstdint>
#include <string>

#include "host/scenario_arguments.h"

namespace armada {

struct FloorOptions {
  ScenarioArguments scenario;
  uint64_t seed = 1;
  std::string seeds;  ///< "A:B", both included; empty: `seed` alone
  int jobs = 0;       ///< threads; 0: all cores
  std::string json;
};

/// `armada floor SCENARIO`: the unavoidable error. Exit code.
int RunFloorCommand(const FloorOptions& options);

/// True where a scenario has a leader to measure against; else one sentence on standard error.
bool HasFloor(const ScenarioConfig& scenario);

}  // namespace armada
