#include "host/check/check_result.h"

#include <algorithm>

#include "firmware/app/leader_news.h"
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
  result.age_max_s = fleet.estimator.age_max_s;
  result.topologies = CheckTopologies(fleet);
  const std::vector<double> news_s = OldestLeaderNews(fleet);
  for (size_t i = 0; i < fleet.arms.size(); ++i) {
    ArmCheck& arm = result.arms.emplace_back();
    arm.id = fleet.arms[i].id;
    arm.dof = fleet.arms[i].arm.dof;
    arm.bus_load = ArmBusLoad(fleet.arms[i], fleet.timing, drive);
    arm.leader_news_s = news_s[i];
  }
  return result;
}

void CollectFindings(const FleetConfig& fleet, CheckResult& result) {
  if (result.A1() && !std::all_of(result.topologies.begin(), result.topologies.end(),
                                  [](const TopologyCheck& topology) { return topology.holds(); })) {
    result.findings.push_back(
        {Severity::kWarning,
         "only all topologies in turn reach every arm, which is less than Corollary 3 asks for: "
         "estimates are extrapolated in between"});
  }
  for (size_t i = 0; i < result.arms.size(); ++i) {
    const std::vector<Finding> of_arm = FindingsOf(fleet.arms[i], result.arms[i]);
    result.findings.insert(result.findings.end(), of_arm.begin(), of_arm.end());
  }
  std::stable_sort(result.findings.begin(), result.findings.end(),
                   [](const Finding& a, const Finding& b) { return a.severity > b.severity; });
}

}  // namespace

bool CheckResult::A1() const {
  const bool each = std::all_of(topologies.begin(), topologies.end(),
                                [](const TopologyCheck& topology) { return topology.holds(); });
  const bool in_turn =
      !leaderless && topologies.size() > 1 && std::all_of(arms.begin(), arms.end(), [&](const ArmCheck& arm) {
        return arm.leader_news_s <= age_max_s + 1e-9;
      });
  return each || in_turn;
}

bool CheckResult::ok() const {
  const bool A2 = !estimator || estimator->holds();
  return A1() && A2 && std::none_of(findings.begin(), findings.end(), [](const Finding& finding) {
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
    const auto bounds = BoundEstimates(scenario);
    for (size_t i = 0; bounds && i < result.arms.size(); ++i) result.arms[i].estimate = (*bounds)[i];
    result.findings = FindingsOfLostLinks(scenario);
    for (size_t i = 0; i < result.arms.size(); ++i) {
      const ArmEntry& entry = scenario.fleet.arms[i];
      result.arms[i].path = CheckPath(scenario, entry, leader);
      if (entry.control.subtask.kind == SubtaskKind::kPosture)
        result.arms[i].posture = CheckPosture(scenario, entry, leader);
    }
  }
  const std::vector<Finding> of_sensors = FindingsOfSensors(scenario);
  result.findings.insert(result.findings.end(), of_sensors.begin(), of_sensors.end());
  CollectFindings(scenario.fleet, result);
  return result;
}

}  // namespace armada
