#pragma once

#include <vector>

#include "firmware/app/config/config_error.h"
#include "firmware/app/config/config_node.h"
#include "firmware/app/config/override.h"

namespace armada {

/// The `base` of a scenario that has none.
inline constexpr const char* kNoBase = "none";

/// Puts the tree of a scenario file on top of the file that its `base` names, that one on its own, and so on.
/// Every value keeps its file and line. [overrides] are taken out of all of them, the deepest first. False
/// when a base cannot be read.
bool PutOnBase(ConfigNode* tree, std::vector<Override>* overrides, std::vector<ConfigError>* errors);

}  // namespace armada
