#include "host/sim/sim_command.h"

#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "firmware/app/exit_codes.h"
#include "hil/scenario_file.h"
#include "host/arm_table.h"
#include "host/floor/floor_command.h"
#include "host/sim/simulation.h"

namespace armada {

bool SimulateInto(const ScenarioConfig& scenario, uint64_t seed, const std::string& directory, bool floor,
                  RunMetrics* metrics, std::string* error) {
  TraceWriter trace(directory, scenario.fleet);
  if (!trace.ok()) {
    *error = trace.error();
    return false;
  }
  Simulation simulation(scenario, seed);
  *metrics = simulation.Run(&trace);
  if (!trace.Close()) {
    *error = trace.error();
    return false;
  }
  if (floor) metrics->CompareWithFloor(scenario);
  return WriteEffective(scenario, directory, error) &&
         simulation.WriteLearned(directory + "/learned", error) &&
         WriteJson(ToJson(*metrics), directory + "/metrics.json", error);
}

int RunSimCommand(const SimOptions& options) {
  const auto scenario = options.scenario.Load();
  if (!scenario) return kExitBadConfig;
  if (options.floor && !HasFloor(*scenario)) return kExitUsage;
  std::string error;
  RunMetrics metrics;
  if (options.trace.empty()) {
    metrics = Simulation(*scenario, options.seed).Run(nullptr);
    if (options.floor) metrics.CompareWithFloor(*scenario);
  } else if (!SimulateInto(*scenario, options.seed, options.trace, options.floor, &metrics, &error)) {
    std::cerr << "armada sim: " << error << '\n';
    return kExitFailed;
  }
  PrintArmTable(metrics, std::cout);
  if (!options.json.empty() && !WriteJson(ToJson(metrics), options.json, &error)) {
    std::cerr << "armada sim: " << error << '\n';
    return kExitFailed;
  }
  return metrics.ok ? kExitOk : kExitFailed;
}

}  // namespace armada
