#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/report/figure.h"
#include "host/report/recorded_sweep.h"

namespace armada {

/// The page of a sweep: verdict, percentiles by figure and arm, worst seeds and those that are not ok with
/// the commands that replay them, figures, the whole summary. Self-contained, as HtmlPage is.
std::string SweepPage(const RecordedSweep& sweep, const std::vector<Figure>& figures,
                      const std::filesystem::path& folder);

}  // namespace armada
