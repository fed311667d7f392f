#pragma once

#include <functional>

#include "hil/scenario.h"

namespace armada {

/// The simplest trial found that still fails: what it can do without is left out, and what is left is
/// rounded. One change at a time, until none helps.
ScenarioConfig Shrink(ScenarioConfig trial, const std::function<bool(const ScenarioConfig&)>& fails);

}  // namespace armada
