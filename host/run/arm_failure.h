#pragma once

#include <cstddef>
#include <optional>

#include "host/run/run_evidence.h"
#include "host/run/run_finding.h"

namespace armada {

/// What an arm misses of the criterion.
struct ArmFailure {
  RunFinding finding;    ///< what, when, and what was late or lost on its board at that moment
  bool in_time = false;  ///< nothing was late or lost there up to then
};

/// None of an arm that misses nothing. Of a run that broke off: whether it has stopped or was never heard.
std::optional<ArmFailure> FailureOf(const RunEvidence& evidence, size_t index);

/// What was late or lost on the arm's board in the window of the criterion, or where nothing was then, before
/// it: of an arm whose fleet misses the criterion. None when nothing was.
std::optional<RunFinding> LatenessOf(const RunEvidence& evidence, size_t index);

/// What the arm's board lost in the whole run; none when it lost nothing, or has left no report.
std::optional<RunFinding> LossesOf(const RunEvidence& evidence, size_t index);

}  // namespace armada
