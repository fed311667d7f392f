#pragma once

#include <span>
#include <vector>

#include "host/run/failure_moment.h"
#include "host/run/run_evidence.h"
#include "host/run/run_finding.h"

namespace armada {

/// Faults that the scenario or somebody ordered, up to `until_s`.
std::vector<RunFinding> FaultFindings(const RunEvidence& evidence, double until_s);

/// When the machine stood still: the `most` longest of these times in order, then one finding of the rest.
std::vector<RunFinding> StallFindings(const RunEvidence& evidence, std::vector<Stall> stalls, size_t most);

/// When the leader was silent though nobody ordered it: the longest such time of the failures' `moments`; of
/// the run, where there is none. Then whether the emulation was late, the programs were started late, or had
/// no real-time priority.
std::vector<RunFinding> ProgramFindings(const RunEvidence& evidence, std::span<const Moment> moments);

}  // namespace armada
