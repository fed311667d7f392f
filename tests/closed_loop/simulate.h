#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "hil/scenario_file.h"
#include "host/sim/simulation.h"

namespace armada {

/// A scenario of hil/scenarios with overrides; fails the test when it does not load.
inline ScenarioConfig ScenarioNamed(const std::string& name, const std::vector<std::string>& sets = {}) {
  std::vector<ConfigError> errors;
  auto scenario =
      LoadScenario(std::string(ARMADA_SOURCE_DIR) + "/hil/scenarios/" + name + ".toml", sets, &errors);
  for (const ConfigError& error : errors) ADD_FAILURE() << ToString(error);
  return scenario.value();
}

inline RunMetrics Simulate(const std::string& name, uint64_t seed,
                           const std::vector<std::string>& sets = {}) {
  return Simulation(ScenarioNamed(name, sets), seed).Run(nullptr);
}

/// Root of the mean over arms of the squared RMS of x_hat - x_0, m.
inline double FleetEstimatorRms(const RunMetrics& metrics) {
  double sum = 0.0;
  for (const ArmMetrics& arm : metrics.arms) sum += arm.estimator_rms.x_m * arm.estimator_rms.x_m;
  return std::sqrt(sum / static_cast<double>(metrics.arms.size()));
}

}  // namespace armada
