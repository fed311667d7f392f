#pragma once

#include <iosfwd>

#include "firmware/core/parameter.h"

namespace armada {

/// Writes a Config struct as a TOML file. The values of a table precede the tables below it, in whatever
/// order the struct visits them.
void WriteToml(const ParameterTable& config, std::ostream& out);

}  // namespace armada
