#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hil/scenario.h"

namespace armada {

class Command;

/// What every command that works on a scenario takes.
struct ScenarioArguments {
  std::string scenario;
  std::string law;
  std::string estimator;
  std::optional<double> seconds;
  std::vector<std::string> sets;

  /// Everything, for commands that run the fleet.
  void AddTo(Command* command);
  /// Without --law and --estimator, for commands that the fleet's control does not concern.
  void AddScenarioTo(Command* command);
  /// The overrides in order: --law, --estimator, --seconds, then each --set.
  std::vector<std::string> Overrides() const;
  /// The scenario with its overrides; every error is printed to stderr when there is none.
  std::optional<ScenarioConfig> Load() const;
};

}  // namespace armada
