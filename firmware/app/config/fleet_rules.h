#pragma once

#include <vector>

#include "firmware/app/config/config_node.h"
#include "firmware/app/config/fleet_layout.h"

namespace armada {

// What a fleet file may not say beyond types and ranges. Each rule reports at the value it is about, and has
// no say where that value could not be read. `root` is the tree the layout was read from.

/// The whole fleet: timing, link, ids, buses, every arm, every topology.
void CheckFleet(const FleetLayout& fleet, const ConfigCursor& root, std::vector<ConfigError>* errors);

/// One arm: links, joints, bus, gains, law and subtask, reach, projection set.
void CheckArm(const FleetLayout& fleet, size_t index, const ConfigCursor& root,
              std::vector<ConfigError>* errors);

/// One arm's limits and obstacles: counts, room, and joints to spare. @pre it has 1 to kMaxDof links.
void CheckBarriers(const ArmLayout& arm, double period_s, const ConfigCursor& root, const ConfigCursor& at,
                   std::vector<ConfigError>* errors);

/// The topologies: known arms, weights, A1 of each or of all in turn, or Corollary 2's tree. @pre arm ids are
/// unique.
void CheckGraphs(const FleetLayout& fleet, const ConfigCursor& root, std::vector<ConfigError>* errors);

}  // namespace armada
