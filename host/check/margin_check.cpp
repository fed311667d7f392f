#include "host/check/margin_check.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/start_state.h"

namespace armada {

bool EstimatorCheck::holds() const {
  return std::all_of(margins.begin(), margins.end(), [](const BetaMargin& margin) { return margin.holds(); });
}

EstimatorCheck CheckEstimator(const ScenarioConfig& scenario, const LeaderPath& leader) {
  const EstimatorConfig& estimator = scenario.fleet.estimator;
  const LeaderBounds bounds = leader.Bounds();
  EstimatorCheck check;
  check.margins = {BetaMargin{estimator.beta_1_m_s, bounds.v_m_s},
                   BetaMargin{estimator.beta_2_m_s2, bounds.a_m_s2},
                   BetaMargin{estimator.beta_3_m_s3, bounds.jerk_m_s3}};

  const std::array<double, 3> errors = LargestStartErrors(scenario.start, leader);
  for (size_t k = 0; k < errors.size(); ++k) {
    const BetaMargin& margin = check.margins[k];
    const double settled_s =
        margin.holds() ? errors[k] / (margin.beta - margin.leader) : std::numeric_limits<double>::infinity();
    check.settled_max_s = std::max(check.settled_max_s, settled_s);
  }
  return check;
}

DisturbanceCheck CheckDisturbance(const ArmEntry& entry, const DisturbanceConfig& disturbance) {
  const double amplitude_Nm = disturbance.kind == DisturbanceKind::kNone ? 0.0 : disturbance.amplitude_Nm;
  return {entry.control.gains.K_r_Nm.minCoeff(),
          amplitude_Nm * std::sqrt(static_cast<double>(entry.arm.dof))};
}

}  // namespace armada
