#pragma once

#include <algorithm>
#include <optional>
#include <span>

#include "host/run/run_evidence.h"

namespace armada {

/// So long before a failure shows, what was late or lost is of that moment.
inline constexpr double kMoment_s = 1.0;

/// The part of a run in which the cause of a failure is looked for.
struct Moment {
  double from_s = 0.0;
  double to_s = 0.0;
};

/// Of a failure that shows at `at_s`. One without a time of its own is of the whole window of the criterion;
/// in a run that broke off, of all of it.
Moment MomentOf(const RunEvidence& evidence, std::optional<double> at_s);

/// Whether what went on from then to then is of one of these moments.
inline bool IsOf(std::span<const Moment> moments, double begin_s, double end_s) {
  return std::any_of(moments.begin(), moments.end(),
                     [&](const Moment& moment) { return end_s > moment.from_s && begin_s < moment.to_s; });
}

}  // namespace armada
