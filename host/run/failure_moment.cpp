#include "host/run/failure_moment.h"

#include <limits>

namespace armada {

Moment MomentOf(const RunEvidence& evidence, std::optional<double> at_s) {
  if (at_s) return {*at_s - kMoment_s, *at_s};
  if (evidence.metrics == nullptr) return {-std::numeric_limits<double>::infinity(), evidence.broke_off_s};
  return {evidence.scenario->window_start_s - kMoment_s, evidence.scenario->seconds};
}

}  // namespace armada
