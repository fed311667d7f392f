#pragma once

#include <CLI/CLI.hpp>

namespace armada {

/// Adds `armada storm`: somebody who sends a fleet what it must not take. `*code` is the exit code after
/// parsing.
void AddStormCommand(CLI::App* app, int* code);

}  // namespace armada
