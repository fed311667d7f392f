#pragma once

#include <vector>

#include "host/run/run_evidence.h"
#include "host/run/run_finding.h"

namespace armada {

/// Why a run in real time is not ok. What came from outside first (faults that were ordered, stalls of the
/// machine before the first failure, then before later ones), then each failure of an arm or the fleet, in
/// the order of time, with what was late or lost on the arm's board at that moment, for the fleet on any
/// board in the window, then what was lost in all. There is always a cause; where nothing was late or lost,
/// that is it. Of a run that is ok it only tells whether the machine stood still.
std::vector<RunFinding> Diagnose(const RunEvidence& evidence);

}  // namespace armada
