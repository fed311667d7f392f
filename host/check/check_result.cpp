#include "host/check/check_result.h"

#include <algorithm>

#include "host/check/bus_load.h"
#include "host/check/findings.h"

namespace armada {
namespace {

CheckResult BuildFleetCheck(const FleetConfig& fleet, double feedback_period_s) {
  CheckResult result;
  result.name = fleet.name;
  result.file = fleet.file;
  result.leaderless = fleet.estimator.leaderless;
  result.period_s = fleet.timing.period_s;
  result.topologies = CheckTopologies(fleet);
  for (const ArmEntry& arm : fleet.arms) {
    const double bus_load = ArmBusLoad(arm, fleet.timing.period_s, feedback_period_s);
    result.arms.push_back({arm.id, arm.arm.dof, bus_load, {}, {}});
  }
  return result;
}

}  // namespace

bool CheckResult::ok() const {
  return std::none_of(findings.begin(), findings.end(),
                      [](const Finding& finding) { return finding.severity == Severity::kError; });
}

CheckResult BuildCheck(const FleetConfig& fleet) {
  CheckResult result = BuildFleetCheck(fleet, 0.0);
  result.findings = Findings(fleet, result);
  return result;
}

CheckResult BuildCheck(const ScenarioConfig& scenario) {
  CheckResult result = BuildFleetCheck(scenario.fleet, scenario.drive.feedback_period_s);
  result.name = scenario.name;
  result.file = scenario.file;
  for (size_t i = 0; i < result.arms.size(); ++i) {
    result.arms[i].disturbance = CheckDisturbance(scenario.fleet.arms[i], scenario.disturbance);
  }
  if (scenario.leader.kind != LeaderKind::kNone) {
    const LeaderPath leader(scenario.leader);
    result.estimator = CheckEstimator(scenario, leader);
    for (size_t i = 0; i < result.arms.size(); ++i) {
      result.arms[i].path = CheckPath(scenario, scenario.fleet.arms[i], leader);
    }
  }
  result.findings = Findings(scenario.fleet, result);
  return result;
}

}  // namespace armada
