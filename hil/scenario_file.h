#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "firmware/app/config/config_error.h"
#include "firmware/app/config/config_node.h"
#include "firmware/app/config/effective_values.h"
#include "firmware/app/config/override.h"
#include "hil/scenario.h"

namespace armada {

/// Reads a scenario file (layout: hil/scenarios/paper.toml, keys: docs/parameters.md) and the fleet file that
/// it names, relative to itself. Its [overrides], then `sets` (`key=value`), go before what the files say; a
/// key may be the scenario's or the fleet's. Nothing, and every error that was found, when a rule is broken.
/// Start-up only.
std::optional<ScenarioConfig> LoadScenario(const std::string& path, const std::vector<std::string>& sets,
                                           std::vector<ConfigError>* errors);

/// The scenario that a tree means; `path` is the file it is said to be of. `overrides` go before its own.
std::optional<ScenarioConfig> ScenarioFromTree(ConfigNode tree, const std::string& path,
                                               const std::vector<Override>& overrides,
                                               std::vector<ConfigError>* errors);

/// Writes `fleet.toml` and `scenario.toml` into an existing directory: every value as this run uses it,
/// overrides applied. LoadScenario reads the same values back. False and one sentence when a file cannot be
/// written.
bool WriteEffective(const ScenarioConfig& scenario, const std::string& directory, std::string* error);

/// Every value of the scenario under its full key, the fleet's not among them.
std::vector<EffectiveValue> EffectiveValues(const ScenarioConfig& scenario);

/// docs/parameters.md: every key of fleet and scenario files.
void WriteParameterReference(std::ostream& out);

}  // namespace armada
