#include "firmware/app/fleet.h"

#include <algorithm>
#include <cmath>

#include "firmware/can/make_drive.h"

namespace armada {

BusOptions BusOptionsOf(const ArmEntry& arm) {
  BusOptions options;
  options.config = arm.can;
  options.fd = std::any_of(arm.joints.begin(), arm.joints.end(), [](const JointDriveConfig& joint) {
    return joint.profile == DriveProfile::kMoteus;
  });
  for (const auto& drive : MakeDrives(arm.joints)) {
    const std::vector<CanFilter> filters = drive->Filters();
    options.filters.insert(options.filters.end(), filters.begin(), filters.end());
  }
  return options;
}

int FleetConfig::IndexOf(int id) const {
  for (size_t i = 0; i < arms.size(); ++i) {
    if (arms[i].id == id) return static_cast<int>(i);
  }
  return -1;
}

Digraph FleetConfig::Graph(size_t topology) const {
  Digraph graph(static_cast<int>(arms.size()));
  for (const Edge& edge : topologies[topology].edges)
    graph.SetWeight(IndexOf(edge.to), IndexOf(edge.from), edge.weight);
  for (const Pin& pin : topologies[topology].pins) graph.SetPin(IndexOf(pin.arm), pin.weight);
  return graph;
}

size_t TopologySchedule::At(double t_s) const {
  if (count == 1 || period_s <= 0.0 || t_s < 0.0) return 0;
  // A tick on the boundary, up to rounding, belongs to the next topology.
  return static_cast<size_t>(std::floor(t_s / period_s + 1e-9)) % count;
}

ArmControllerConfig FleetConfig::ControllerConfig(size_t index) const {
  const ArmEntry& entry = arms[index];
  JointVector torque_limit_Nm(entry.arm.dof);
  for (int i = 0; i < entry.arm.dof; ++i)
    torque_limit_Nm[i] = entry.joints[static_cast<size_t>(i)].torque_limit_Nm;
  return {timing, entry.arm, estimator, entry.control, torque_limit_Nm};
}

}  // namespace armada
