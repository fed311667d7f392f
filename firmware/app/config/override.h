#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/app/config/config_node.h"

namespace armada {

/// A value put in place of a file's: `--set key=value`, or a line of a scenario's [overrides]. Keys are
/// dotted; elements of lists go by `id`, or by number from 1, and `*` stands for each: "arm.*.gravity_m_s2",
/// "arm.6.control.subtask.kind".
struct Override {
  std::string key;
  ConfigNode value;  ///< with the override's own place
};

/// Each `key=value`; the value is TOML, or a bare word that stands for itself in quotes.
std::vector<Override> ParseSets(const std::vector<std::string>& sets, std::vector<ConfigError>* errors);

/// The entries of an [overrides] table.
std::vector<Override> OverridesIn(const ConfigNode& table);

/// Puts the value into the tree, adding tables on the way; lists are not grown. Whether the key means
/// anything is seen when the tree is read.
void Apply(const Override& change, ConfigNode* root, std::vector<ConfigError>* errors);

}  // namespace armada
