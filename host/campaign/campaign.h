#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "hil/scenario.h"
#include "host/campaign/coverage.h"

namespace armada {

struct CampaignOptions {
  uint64_t first_seed = 1;
  size_t trials = 10'000;
  int jobs = 0;           ///< processes at once; 0: one a core
  bool replay = false;    ///< the scenario as it is, instead of trials drawn from it
  std::string directory;  ///< takes the scripts of trials that failed
};

/// A trial that failed, and its smallest script.
struct FailedTrial {
  uint64_t seed;
  Violation violation;  ///< the first
  size_t violations;    ///< of the trial
  std::string script;   ///< path; empty for a replay
};

struct CampaignResult {
  Coverage coverage;
  std::vector<FailedTrial> failed;  ///< by seed
};

/// Runs the trials, each in a process of its own, and shrinks those that fail. `progress` is told after each.
/// Throws std::system_error when there can be no more processes, or a script cannot be written.
CampaignResult RunCampaign(const ScenarioConfig& base, const CampaignOptions& options,
                           const std::function<void(size_t done, size_t failed)>& progress);

}  // namespace armada
