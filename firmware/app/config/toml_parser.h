#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/app/config/config_node.h"

namespace armada {

inline constexpr size_t kMaxConfigBytes = size_t{1024} * 1024;

/// Parses TOML text; `file` names it in places. Of syntax errors, duplicate keys among them, the first is
/// reported.
std::optional<ConfigNode> ParseToml(std::string_view text, const std::string& file,
                                    std::vector<ConfigError>* errors);

/// Reads and parses a file of at most kMaxConfigBytes.
std::optional<ConfigNode> LoadToml(const std::string& path, std::vector<ConfigError>* errors);

}  // namespace armada
