#pragma once

#include "host/run/run_command.h"

namespace armada {

/// `armada run --bus vm`: this process becomes hil/vm/run, which runs the same command with --bus socketcan
/// in a kernel that has CAN. Returns only when it cannot, an exit code.
int RunInVm(const RunOptions& options);

}  // namespace armada
