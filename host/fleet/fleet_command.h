#pragma once

namespace armada {

class Command;

/// Adds `armada fleet`: it prints a fleet file. `*code` is the exit code after parsing.
void AddFleetCommand(Command* app, int* code);

}  // namespace armada
