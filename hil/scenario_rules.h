#pragma once

#include <vector>

#include "firmware/app/config/config_node.h"
#include "hil/scenario.h"

namespace armada {

// What a scenario may not say beyond types and ranges. Each rule reports at the value it is about.

/// Rules that need no fleet: the window, the shape of the leader's path and of the start.
void CheckScenario(const ScenarioConfig& scenario, const ConfigCursor& root,
                   std::vector<ConfigError>* errors);

/// Rules between scenario and fleet: leader or none, A2, reach, time steps. @pre both are clean by
/// themselves.
void CheckScenarioWithFleet(const ScenarioConfig& scenario, const ConfigCursor& root,
                            const ConfigCursor& fleet_root, std::vector<ConfigError>* errors);

}  // namespace armada
