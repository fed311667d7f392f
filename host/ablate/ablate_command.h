#pragma once

#include <string>

#include "host/scenario_arguments.h"

namespace armada {

struct AblateOptions {
  ScenarioArguments scenario;
  std::string seeds = "1:50";  ///< "A:B", both included
  int jobs = 0;                ///< threads; 0: all cores
  std::string json;
};

/// `armada ablate SCENARIO`: the fleet over the same seeds whole and with one component of its law or
/// estimator taken out at a time. Exit code: ok when the whole law is, on every seed.
int RunAblateCommand(const AblateOptions& options);

}  // namespace armada
