#pragma once

#include <filesystem>
#include <vector>

#include "host/report/figure.h"

namespace armada {

/// Estimates, task-space states and paths in the plane: Figs. 3, 4 and 5 of the paper.
std::vector<Figure> TaskSpaceFigures(const RecordedRun& run);

/// One figure for each arm with a subtask, with and without it: Figs. 6 (posture) and 7 (manipulability) of
/// the paper.
std::vector<Figure> SubtaskFigures(const RecordedRun& run);

/// Distance of each end-effector from the leader. Writes `folder`/error.csv, which the figure draws.
Figure ErrorFigure(const RecordedRun& run, const std::filesystem::path& folder);

Figure TorqueFigure(const RecordedRun& run);

/// Distributions of the real-time loop's times. @pre run.timing
Figure TimingFigure(const RecordedRun& run);

}  // namespace armada
