#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/app/config/config_error.h"

namespace armada {

enum class GraphShape {
  kRing,    ///< each hears the one before, the first the last
  kLine,    ///< each hears the one before
  kTree,    ///< arm i hears arm i / 2
  kRandom,  ///< each hears an earlier one, which makes a tree from the leader, and one more: cycles, random
            ///< weights
};

/// What `armada fleet` makes.
struct FleetPlan {
  GraphShape graph = GraphShape::kLine;
  std::string like;  ///< fleet file: its arms in turn, and all else
  std::string name;  ///< of the fleet
  int arms = 7;
  int pins = 1;         ///< the first arms, which hear the leader
  double vary = 0.0;    ///< lengths, masses and inertias of links within +- this share of the file's
  uint64_t seed = 1;    ///< of what is random
  std::string command;  ///< that asked for it, for the file's heading
};

/// The text of a fleet file that keeps every rule: arms are drawn again until they do. sync_ticks and
/// age_max_s are raised where the graph is too deep for the file's. Nothing, and every error, when there is
/// no such fleet.
std::optional<std::string> GenerateFleet(const FleetPlan& plan, std::vector<ConfigError>* errors);

}  // namespace armada
