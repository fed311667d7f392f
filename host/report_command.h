#pragma once

#include <string>

namespace armada {

/// `armada report PATH`: figures and a page of a run that `armada run` or `armada sim --trace` left in the
/// directory PATH, or of the sweep in the file PATH or in PATH/sweep.json. Where a run's arms have subtasks,
/// their twin run without is simulated first, for comparison. Exit code.
int RunReportCommand(const std::string& path);

}  // namespace armada
