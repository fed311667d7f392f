#pragma once

#include <iosfwd>

#include "host/sweep/sweep_result.h"

namespace armada {

/// The result of a sweep for people: percentiles by figure and arm, the worst seeds and those that are not
/// ok, each with the command that replays it, and the verdict.
void PrintSweep(const Sweep& sweep, const SweepSummary& summary, std::ostream& out);

}  // namespace armada
