#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hil/scenario.h"
#include "host/campaign/violation.h"

namespace armada {

/// What came of a trial.
struct TrialResult {
  Violations violations;
  uint32_t transitions = 0;             ///< bits of kTransitions
  std::vector<std::optional<int>> met;  ///< by fault: the state in which it met its arm
};

/// Runs a trial under its judge, in this process.
TrialResult RunTrial(const ScenarioConfig& trial, uint64_t seed);

/// For the way between processes.
std::string ToText(const TrialResult& result);
TrialResult TrialResultOf(const std::string& text);

}  // namespace armada
