#pragma once

#include <filesystem>
#include <vector>

#include "host/report/figure.h"
#include "host/report/recorded_sweep.h"

namespace armada {

/// Settling time, RMS and largest error over the seeds: histogram, share below, share above. Writes the table
/// that each draws, `folder`/<name>.csv.
std::vector<Figure> SweepFigures(const RecordedSweep& sweep, const std::filesystem::path& folder);

/// The gnuplot script of such a figure.
std::string ScriptText(const Figure& figure, const RecordedSweep& sweep);

}  // namespace armada
