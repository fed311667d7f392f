#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "host/report/recorded_run.h"

namespace armada {

/// What a real-time run measured of its processes: one row a quantity, one column a process.
struct ProcessTable {
  std::vector<std::string> processes;
  std::vector<std::string> quantities;  ///< "timing.compute_us.p99", in the order of metrics.json
  std::map<std::pair<std::string, std::string>, Json> values;  ///< by (quantity, process)
};

/// Collects every object of metrics.json that has `timing`, `memory` or `bus`. A process is called by its
/// "name", else "arm <id>", else by the key it stands under. Of a list, as `bus.lcm_heard[]` of all senders,
/// it has the sums.
ProcessTable CollectProcesses(const Json& metrics);

}  // namespace armada
