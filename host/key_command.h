#pragma once

#include <CLI/CLI.hpp>

namespace armada {

/// Adds `armada key`: it makes the key of a fleet. `*code` is the exit code after parsing.
void AddKeyCommand(CLI::App* app, int* code);

}  // namespace armada
