#pragma once

namespace armada {

class Command;

/// `armada ctl`: an operator's commands to running boards.
void AddCtlCommand(Command* app, int* code);

}  // namespace armada
