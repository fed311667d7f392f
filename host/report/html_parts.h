#pragma once

#include <filesystem>
#include <string>

#include "host/report/figure.h"

namespace armada {

/// From the first line of a page to the start of its body. `title` is escaped already.
std::string PageOpening(const std::string& title);

/// The figure with its caption. Throws ReportError where `folder`/<name>.svg is missing.
std::string FigureElement(const Figure& figure, size_t number, const std::filesystem::path& folder);

}  // namespace armada
