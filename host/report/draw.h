#pragma once

#include <filesystem>
#include <string>

#include "host/report/figure.h"

namespace armada {

/// Writes `script` as <name>.gp and lets gnuplot draw <name>.svg and <name>.png beside it; where that fails
/// only the script stays, to be looked at. Throws ReportError.
void Draw(const Figure& figure, const std::string& script, const std::filesystem::path& folder);

/// Writes the page as a whole or not at all, by way of `folder`. Throws ReportError.
void WritePage(const std::string& html, const std::filesystem::path& folder,
               const std::filesystem::path& page);

}  // namespace armada
