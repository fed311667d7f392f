#pragma once

#include <CLI/CLI.hpp>

namespace armada {

/// Adds `armada fleet`: it prints a fleet file. `*code` is the exit code after parsing.
void AddFleetCommand(CLI::App* app, int* code);

}  // namespace armada
