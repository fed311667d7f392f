#pragma once

#include <CLI/CLI.hpp>

namespace armada {

/// `armada fault`: a fault into a run that goes on.
void AddFaultCommand(CLI::App* app, int* code);

}  // namespace armada
