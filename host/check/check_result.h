#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hil/estimate_bound.h"
#include "host/check/graph_check.h"
#include "host/check/margin_check.h"
#include "host/check/path_check.h"
#include "host/check/posture_check.h"

namespace armada {

enum class Severity {
  kWarning,  ///< a condition of the theorem or a margin is missed; the fleet may still work
  kError,    ///< the task cannot be done as configured
};

struct Finding {
  Severity severity = Severity::kWarning;
  std::string text;
};

struct ArmCheck {
  int id = 0;
  int dof = 0;
  double bus_load = 0.0;                  ///< share of its bus
  double leader_news_s = 0.0;             ///< age that its news of the leader reach; infinite: never any
  std::optional<EstimateBound> estimate;  ///< of a scenario, where BoundEstimates applies
  std::optional<DisturbanceCheck> disturbance;  ///< of a scenario
  std::optional<PathCheck> path;                ///< of a scenario with a leader
  std::optional<PostureCheck> posture;          ///< the same, of an arm with a posture
};

/// What `armada check` finds out about a fleet or a scenario beyond the rules that the loader enforces.
struct CheckResult {
  std::string name;
  std::string file;
  bool leaderless = false;
  double period_s = 0.0;
  double age_max_s = 0.0;  ///< estimator.age_max_s
  std::vector<TopologyCheck> topologies;
  std::vector<ArmCheck> arms;               ///< in the fleet's order
  std::optional<EstimatorCheck> estimator;  ///< of a scenario with a leader
  std::vector<Finding> findings;            ///< errors first

  /// Each topology by itself, or with a leader all in turn before its news count as lost.
  bool A1() const;
  bool ok() const;  ///< A1 and A2 hold, and no finding is an error
};

/// The fleet alone: graph and bus.
CheckResult BuildCheck(const FleetConfig& fleet);

/// The fleet in its scenario: all of it.
CheckResult BuildCheck(const ScenarioConfig& scenario);

}  // namespace armada
