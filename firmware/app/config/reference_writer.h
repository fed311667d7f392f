#pragma once

#include <string>
#include <utility>
#include <vector>

#include "firmware/core/parameter.h"

namespace armada {

/// Headings of the structs documented so far.
using DocumentedTables = std::vector<std::pair<ParameterTable::Type, std::string>>;

/// Documents a Config struct in markdown: a section for each table of the file. A struct that comes again is
/// documented where it came first.
std::string ReferenceText(const ParameterTable& config, DocumentedTables* documented);

}  // namespace armada
