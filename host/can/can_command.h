#pragma once

namespace armada {

class Command;

/// Adds `armada can`: dbc, eds, decode, scan and check. `code` is where their callbacks leave the exit code.
void AddCanCommand(Command* app, int* code);

}  // namespace armada
