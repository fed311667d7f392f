#pragma once

#include "firmware/core/estimator.h"

namespace armada {

inline constexpr EstimatorKind kEstimatorKinds[] = {EstimatorKind::kPaper, EstimatorKind::kImplicit,
                                                    EstimatorKind::kPredictive};

/// An estimator of that kind, all else by default.
inline EstimatorConfig ConfigOf(EstimatorKind kind) {
  EstimatorConfig config;
  config.kind = kind;
  return config;
}

}  // namespace armada
