#pragma once

namespace armada {

class Command;

/// `armada fault`: a fault into a run that goes on.
void AddFaultCommand(Command* app, int* code);

}  // namespace armada
