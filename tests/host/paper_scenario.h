#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "host/check/check_result.h"

namespace armada {

inline ArmEntry Arm(int id, const std::vector<LinkConfig>& links) {
  ArmEntry entry;
  entry.id = id;
  entry.arm.dof = static_cast<int>(links.size());
  std::copy(links.begin(), links.end(), entry.arm.links.begin());
  entry.bus = "udp:239.0.0.1:" + std::to_string(5000 + id);
  for (int node_id = 1; node_id <= entry.arm.dof; ++node_id) {
    entry.joints.push_back({.node_id = node_id, .torque_limit_Nm = entry.arm.dof == 2 ? 150.0 : 300.0});
  }
  entry.control.Expand(entry.arm.dof, PlanarArm::kTaskDim);
  return entry;
}

// Section 4 of the paper: its Table 1, its graph, its leader.
inline ScenarioConfig PaperScenario() {
  ScenarioConfig scenario;
  FleetConfig& fleet = scenario.fleet;
  fleet.arms = {Arm(1, {{0.8, 1.4, 0.8, 6}, {0.6, 0.9, 0.45, 3}}),
                Arm(2, {{1.0, 1.2, 0.7, 2}, {0.8, 1.1, 0.5, 3}}),
                Arm(3, {{0.5, 1.1, 0.4, 5}, {0.8, 1.3, 0.6, 3}}),
                Arm(4, {{1.5, 1.1, 0.6, 5}, {0.8, 1.2, 0.6, 4}}),
                Arm(5, {{2.3, 1.0, 0.4, 5}, {0.8, 1.2, 0.7, 3}}),
                Arm(6, {{0.8, 0.8, 0.4, 4}, {1.2, 1.1, 0.5, 6}, {1.4, 1.4, 0.7, 5}}),
                Arm(7, {{1.8, 1.0, 0.6, 5}, {1.2, 1.1, 0.6, 6}, {1.4, 1.2, 0.6, 5}})};
  fleet.topologies = {{{{1, 2}, {3, 2}, {1, 4}, {3, 4}, {5, 6}}, {{1}, {3}, {5}, {7}}}};
  scenario.start.zeta_x_centre_m = TaskVector::Zero(2);
  scenario.leader.axes = {{1.2, 0.5, 0.5, 0.0}, {1.3, 0.3, 0.5, M_PI / 2}};
  return scenario;
}

inline bool Mentions(const CheckResult& result, Severity severity, const std::string& text) {
  return std::any_of(result.findings.begin(), result.findings.end(), [&](const Finding& finding) {
    return finding.severity == severity && finding.text.find(text) != std::string::npos;
  });
}

}  // namespace armada
