#pragma once

#include <string>

namespace armada {

/// `armada report DIR`: figures and a page of a run that `armada run` or `armada sim --trace` left in DIR.
/// Where arms have subtasks, their twin run without is simulated first, for comparison. Exit code.
int RunReportCommand(const std::string& directory);

}  // namespace armada
