#pragma once

#include <cstdint>

#include "hil/scenario.h"

namespace armada {

/// From here on an arm that started running near its leader follows it.
inline constexpr double kSettled_s = 3.5;
/// The last fault or request comes before this; what is left of a trial is enough for every stop.
inline constexpr double kLastEvent_s = 5.5;

/// A trial of the campaign: `base` with one fault or a pair, and in every third trial with an operator who
/// arms and starts the fleet, and asks for more at random. In every fourth, all arms stop with a neighbour;
/// in every second, the fleet has drives of some family.
ScenarioConfig DrawTrial(const ScenarioConfig& base, uint64_t seed);

}  // namespace armada
