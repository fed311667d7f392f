#pragma once

#include <nlohmann/json.hpp>

namespace armada {

/// Keys stay in the order in which they were written.
using Json = nlohmann::ordered_json;

}  // namespace armada
