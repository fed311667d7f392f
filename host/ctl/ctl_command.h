#pragma once

#include <CLI/CLI.hpp>

namespace armada {

/// `armada ctl`: an operator's commands to running boards.
void AddCtlCommand(CLI::App* app, int* code);

}  // namespace armada
