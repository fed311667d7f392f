#pragma once

#include <string>

#include "firmware/app/config/config_node.h"

namespace armada {

/// A tree as a TOML file for people: in every table values first, then tables and lists of tables under
/// headers of their own; a list of tables that hold single values only is written inline, short ones several
/// to a line.
std::string TomlText(const ConfigNode& root);

}  // namespace armada
