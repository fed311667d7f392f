#pragma once

#include <string>
#include <vector>

#include "host/scenario_arguments.h"

namespace armada {

struct SweepOptions {
  ScenarioArguments scenario;
  std::string seeds = "1:100";  ///< "A:B", both included
  std::string shard = "1/1";    ///< "I/N": every N-th seed, from the I-th
  int jobs = 0;                 ///< threads; 0: all cores
  std::string json;
  bool floor = false;  ///< the unavoidable error of every seed, too
};

/// `armada sweep SCENARIO`: the same scenario over many seeds. Exit code: ok when every fleet is.
int RunSweepCommand(const SweepOptions& options);

/// `armada sweep merge FILES...`: one result of the shards' results.
int RunSweepMergeCommand(const std::vector<std::string>& files, const std::string& json);

}  // namespace armada
