#pragma once

#include <vector>

#include "firmware/app/config/config_node.h"
#include "firmware/core/parameter.h"

namespace armada {

/// Fills a Config struct from the root of a file, and collects every mistake in it.
void ReadConfig(const ConfigNode& root, const ParameterTable& config, std::vector<ConfigError>* errors);

}  // namespace armada
