#pragma once

namespace armada {

class Command;

/// Adds `armada storm`: somebody who sends a fleet what it must not take. `*code` is the exit code after
/// parsing.
void AddStormCommand(Command* app, int* code);

}  // namespace armada
