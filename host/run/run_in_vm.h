#pragma once

#include "hil/scenario.h"
#include "host/run/run_command.h"

namespace armada {

/// `armada run --bus vm`: this process becomes hil/vm/run_virtual, which runs the scenario with --bus
/// socketcan in a kernel that has CAN, in virtual time. `options.out` exists. Returns only when it cannot, an
/// exit code.
int RunInVm(const RunOptions& options, const ScenarioConfig& scenario);

}  // namespace armada
