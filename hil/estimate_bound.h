#pragma once

#include <optional>
#include <vector>

#include "hil/scenario.h"

namespace armada {

/// Largest error of an arm's estimate of the leader on any axis.
struct EstimateBound {
  double x_m = 0.0;
  double v_m_s = 0.0;
  double a_m_s2 = 0.0;
};

/// What no estimate exceeds in the scenario's window, by the arms' index: for every leader within the bounds
/// of the scenario's, every start within its box, and the contacts that its topologies, lost links and delay
/// leave. It is Estimator::Update on bounds of errors in place of states; docs/equations.md derives it. After
/// T s without contact a bound has grown by sup|d jerk/dt| T^4/24 in x, with a jerk that jumps by 2 sup|jerk|
/// T^3/6. Nothing where it does not apply: without a leader, with messages lost at random, or for an
/// estimator that does not predict.
std::optional<std::vector<EstimateBound>> BoundEstimates(const ScenarioConfig& scenario);

}  // namespace armada
