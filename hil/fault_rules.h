#pragma once

#include <vector>

#include "firmware/app/config/config_node.h"
#include "hil/scenario.h"

namespace armada {

/// What a scenario may not say of its faults: whom they meet, when they end, how much. `at`: the list.
/// @pre fleet and scenario are clean by themselves.
void CheckFaults(const ScenarioConfig& scenario, const ConfigCursor& at, std::vector<ConfigError>* errors);

}  // namespace armada
