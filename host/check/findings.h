#pragma once

#include <string>
#include <vector>

#include "firmware/app/fleet.h"
#include "host/check/check_result.h"

namespace armada {

/// What a person must know about one arm, one sentence each. `entry` is the arm that was checked.
std::vector<Finding> FindingsOf(const ArmEntry& entry, const ArmCheck& arm);

/// Who loses the leader by links that fail for good, and whether the criterion says so.
std::vector<Finding> FindingsOfLostLinks(const ScenarioConfig& scenario);

/// Whose law believes its samples to be better than the scenario's drives measure.
std::vector<Finding> FindingsOfSensors(const ScenarioConfig& scenario);

/// What is wrong with a load of ArmBusLoad; empty when nothing is.
std::string BusLoadError(double load);

/// A number with a fixed count of decimals, for people.
std::string Fixed(double value, int decimals);

}  // namespace armada
