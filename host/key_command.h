#pragma once

namespace armada {

class Command;

/// Adds `armada key`: it makes the key of a fleet. `*code` is the exit code after parsing.
void AddKeyCommand(Command* app, int* code);

}  // namespace armada
