#pragma once

#include <filesystem>
#include <vector>

#include "host/report/figure.h"

namespace armada {

/// Estimates, task-space states and paths in the plane: Figs. 3, 4 and 5 of the paper.
std::vector<Figure> TaskSpaceFigures(const RecordedRun& run);

/// Figures for each arm with a use for its spare joints, with and without it: the joints of one with a
/// posture (Fig. 6 of the paper) or limits, the manipulability of one that raises it (Fig. 7), and the
/// clearance of one with obstacles.
std::vector<Figure> SubtaskFigures(const RecordedRun& run);

/// Distance of each end-effector from the leader. Writes `folder`/error.csv, which the figure draws.
Figure ErrorFigure(const RecordedRun& run, const std::filesystem::path& folder);

Figure TorqueFigure(const RecordedRun& run);

/// Distributions of the real-time loop's times. @pre run.timing
Figure TimingFigure(const RecordedRun& run);

}  // namespace armada
