#pragma once

namespace armada {

class Command;

/// `armada campaign`: random faults, and a judge.
void AddCampaignCommand(Command* app, int* code);

}  // namespace armada
