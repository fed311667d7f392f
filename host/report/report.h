#pragma once

#include <filesystem>
#include <string>

namespace armada {

/// `armada report DIR`: draws the figures of the run recorded in `dir` (`metrics.json`, `leader.csv`,
/// `arm_<id>.csv`, optionally `without_subtask/` and `timing.csv`; see recorded_run.h) and writes one page.
///
/// Leaves `dir/report/<figure>.{gp,svg,png}` and, last, the self-contained `dir/report.html`. An earlier page
/// is removed first, so that a page that exists always belongs to figures that were all drawn. Returns false
/// and one message that names the file or program at fault; needs gnuplot on PATH.
bool WriteReport(const std::filesystem::path& dir, std::string* error);

/// `armada report SWEEP.json`: the same of a sweep. Leaves SWEEP.report/<figure>.{gp,csv,svg,png} and, last,
/// SWEEP.html beside the file.
bool WriteSweepReport(const std::filesystem::path& sweep, std::string* error);

}  // namespace armada
