#pragma once

#include <string>

#include "hil/scenario.h"

namespace armada {

/// A trial as a scenario file on top of the file that the campaign was drawn from. `directory`: where it will
/// lie; `comment`: its first lines.
std::string ScriptOf(const ScenarioConfig& trial, const std::string& name, const std::string& directory,
                     const std::string& comment);

}  // namespace armada
