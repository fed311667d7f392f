#include "firmware/app/fleet.h"

#include <algorithm>
#include <cmath>

#include "firmware/can/feedback_step.h"
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
  ArmControllerConfig config{timing, entry.arm, estimator, entry.control, torque_limit_Nm};
  // A step is an error uniform over it: its deviation is step / sqrt(12).
  const auto with_step = [](double deviation, double step) {
    return std::hypot(deviation, step / std::sqrt(12.0));
  };
  for (int i = 0; i < entry.arm.dof; ++i) {
    const FeedbackStep step = FeedbackStepOf(entry.joints[static_cast<size_t>(i)]);
    double& position_rad = config.control.sensor.position_deviation_rad[i];
    double& velocity_rad_s = config.control.sensor.velocity_deviation_rad_s[i];
    position_rad = with_step(position_rad, step.position_rad);
    velocity_rad_s = with_step(velocity_rad_s, step.velocity_rad_s);
  }
  return config;
}

}  // namespace armada
