#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "firmware/app/config/config_error.h"
#include "firmware/app/config/config_node.h"
#include "firmware/app/config/effective_values.h"
#include "firmware/app/config/override.h"
#include "firmware/app/fleet.h"

namespace armada {

/// Reads a fleet file (layout: firmware/fleets/paper.toml, keys: docs/parameters.md), with `key=value`
/// overrides on top. Nothing, and every error that was found, when the file breaks a rule. Start-up only.
std::optional<FleetConfig> LoadFleet(const std::string& path, const std::vector<std::string>& sets,
                                     std::vector<ConfigError>* errors);

/// A fleet with the tree that it was read from, for rules that look at more than the fleet.
struct LoadedFleet {
  FleetConfig fleet;
  ConfigNode tree;
};
std::optional<LoadedFleet> LoadFleetTree(const std::string& path, const std::vector<Override>& overrides,
                                         std::vector<ConfigError>* errors);

/// The fleet that a tree means; `path` is the file it is said to be of.
std::optional<LoadedFleet> FleetFromTree(ConfigNode tree, const std::string& path,
                                         std::vector<ConfigError>* errors);

/// Writes a fleet file that reads back to the same values; every parameter is spelled out.
void WriteFleet(const FleetConfig& fleet, std::ostream& out);

/// What a fleet file says, as a number: boards whose numbers differ have different files. Where a board keeps
/// its key is its own matter.
int64_t FleetDigest(const FleetConfig& fleet);

/// Every value of the fleet under its full key, defaults included.
std::vector<EffectiveValue> EffectiveValues(const FleetConfig& fleet);

/// Keys that may stand at the top of a fleet file.
std::vector<std::string> FleetKeys();

}  // namespace armada
