#include "host/check/check_result.h"

#include <algorithm>

#include "host/check/bus_load.h"
#include "host/check/findings.h"

namespace armada {
namespace {

CheckResult BuildFleetCheck(const FleetConfig& fleet, const EmulatedDriveConfig& drive) {
  CheckResult result;
  result.name = fleet.name;
  result.file = fleet.file;
  result.leaderless = fleet.estimator.leaderless;
  result.period_s = fleet.timing.period_s;
  result.topologies = CheckTopologies(fleet);
  for (const ArmEntry& arm : fleet.arms) {
    const double bus_load = ArmBusLoad(arm, fleet.timing.period_s, drive);
    result.arms.push_back({arm.id, arm.arm.dof, bus_load, {}, {}, {}});
  }
  return result;
}

void CollectFindings(const FleetConfig& fleet, CheckResult& result) {
  for (size_t i = 0; i < result.arms.size(); ++i) {
    const std::vector<Finding> of_arm = FindingsOf(fleet.arms[i], result.arms[i]);
    result.findings.insert(result.findings.end(), of_arm.begin(), of_arm.end());
  }
  std::stable_sort(result.findings.begin(), result.findings.end(),
                   [](const Finding& a, const Finding& b) { return a.severity > b.severity; });
}

}  // namespace

bool CheckResult::ok() const {
  const bool A1 = std::all_of(topologies.begin(), topologies.end(),
                              [](const TopologyCheck& topology) { return topology.holds(); });
  const bool A2 = !estimator || estimator->holds();
  return A1 && A2 && std::none_of(findings.begin(), findings.end(), [](const Finding& finding) {
           return finding.severity == Severity::kError;
         });
}

CheckResult BuildCheck(const FleetConfig& fleet) {
  CheckResult result = BuildFleetCheck(fleet, {});
  CollectFindings(fleet, result);
  return result;
}

CheckResult BuildCheck(const ScenarioConfig& scenario) {
  CheckResult result = BuildFleetCheck(scenario.fleet, scenario.drive);
  result.name = scenario.name;
  result.file = scenario.file;
  for (size_t i = 0; i < result.arms.size(); ++i) {
    result.arms[i].disturbance = CheckDisturbance(scenario.fleet.arms[i], scenario.disturbance);
  }
  if (scenario.leader.kind != LeaderKind::kNone) {
    const LeaderPath leader(scenario.leader);
    result.estimator = CheckEstimator(scenario, leader);
    for (size_t i = 0; i < result.arms.size(); ++i) {
      const ArmEntry& entry = scenario.fleet.arms[i];
      result.arms[i].path = CheckPath(scenario, entry, leader);
      if (entry.control.subtask.kind == SubtaskKind::kPosture)
        result.arms[i].posture = CheckPosture(scenario, entry, leader);
    }
  }
  CollectFindings(scenario.fleet, result);
  return result;
}

}  // namespace armada
