#pragma once

#include <iosfwd>

#include "host/metrics.h"

namespace armada {

/// The result of a run for people: one line an arm, then the verdict.
void PrintArmTable(const RunMetrics& metrics, std::ostream& out);

}  // namespace armada
