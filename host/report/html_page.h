#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/report/figure.h"
#include "host/report/recorded_run.h"

namespace armada {

/// The page: verdict, table of arms, processes of a real-time run, figures with captions, all metrics.
/// Self-contained: figures are inlined from `folder`/<name>.svg, nothing is fetched. Throws ReportError where
/// an SVG is missing.
std::string HtmlPage(const RecordedRun& run, const std::vector<Figure>& figures,
                     const std::filesystem::path& folder);

}  // namespace armada
