#pragma once

#include <string>
#include <vector>

#include "firmware/app/config/config_error.h"
#include "firmware/app/fleet.h"

namespace armada {

/// The text of a file; ends the process when it cannot be read.
std::string ReadText(const std::string& path);

/// Requires of a refusal that it is explained: at least one error, each with a message, and with a line of
/// the text if it is of this file.
void RequireExplained(const std::vector<ConfigError>& errors, const std::string& file,
                      const std::string& text);

/// Requires of a fleet that was accepted what boards rely on: finite, ordered, and written it reads back to
/// the same; and that each arm's board can be made, and gives finite torques within their limits.
void RequireSound(const FleetConfig& fleet);

}  // namespace armada
