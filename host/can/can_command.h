#pragma once

#include <CLI/CLI.hpp>

namespace armada {

/// Adds `armada can`: dbc, eds, decode, scan and check. `code` is where their callbacks leave the exit code.
void AddCanCommand(CLI::App* app, int* code);

}  // namespace armada
