#pragma once

#include <vector>

#include "host/run/finding.h"
#include "host/run/run_evidence.h"

namespace armada {

/// Faults that the scenario or somebody ordered, up to `until_s`.
std::vector<Finding> FaultFindings(const RunEvidence& evidence, double until_s);

/// When the machine stood still: the `most` longest times in order, then one finding of the rest.
std::vector<Finding> StallFindings(const RunEvidence& evidence, size_t most);

/// Whether the emulation was late, and whether the programs had no real-time priority.
std::vector<Finding> ProgramFindings(const RunEvidence& evidence);

}  // namespace armada
