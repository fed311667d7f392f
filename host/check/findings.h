#pragma once

#include <string>
#include <vector>

#include "host/check/check_result.h"

namespace armada {

/// What in a result a person must know, one sentence each, errors first. `fleet` is the one that was checked.
std::vector<Finding> Findings(const FleetConfig& fleet, const CheckResult& result);

/// A number with a fixed count of decimals, for people.
std::string Fixed(double value, int decimals);

}  // namespace armada
