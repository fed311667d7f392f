#pragma once

#include <CLI/CLI.hpp>

namespace armada {

/// `armada campaign`: random faults, and a judge.
void AddCampaignCommand(CLI::App* app, int* code);

}  // namespace armada
