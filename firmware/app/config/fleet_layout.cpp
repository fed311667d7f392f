#include "firmware/app/config/fleet_layout.h"

#include <algorithm>
#include <filesystem>
#include <limits>

namespace armada {
namespace {

ArmEntry EntryOf(const ArmLayout& layout) {
  ArmEntry entry;
  entry.id = layout.id;
  entry.arm = PlanarArmOf(layout);
  entry.bus = layout.bus;
  entry.can = layout.can;
  entry.joints = layout.joint;
  entry.control = layout.control;
  entry.control.Expand(entry.arm.dof, PlanarArm::kTaskDim);
  if (entry.control.law == LawKind::kPaper) entry.control.subtask.form = PostureForm::kPrinted;
  return entry;
}

ArmLayout ArmLayoutOf(const ArmEntry& entry) {
  ArmLayout layout;
  layout.id = entry.id;
  layout.bus = entry.bus;
  layout.can = entry.can;
  const JointDriveConfig& first = entry.joints.front();
  layout.drive = first.profile;
  layout.watchdog_s = first.watchdog_s;
  layout.bring_up_attempts = first.bring_up_attempts;
  layout.odrive = first.odrive;
  layout.mit = first.mit;
  layout.cia402 = first.cia402;
  layout.moteus = first.moteus;
  layout.torque_limit_Nm.resize(entry.arm.dof);
  for (size_t i = 0; i < entry.joints.size(); ++i) {
    layout.torque_limit_Nm[static_cast<Eigen::Index>(i)] = entry.joints[i].torque_limit_Nm;
  }
  layout.arm = entry.arm;
  layout.link.assign(entry.arm.links.begin(), entry.arm.links.begin() + entry.arm.dof);
  layout.obstacle.assign(entry.arm.obstacles.begin(), entry.arm.obstacles.begin() + entry.arm.obstacle_count);
  layout.joint = entry.joints;
  layout.control = entry.control;
  return layout;
}

}  // namespace

JointDriveConfig ArmLayout::JointPrototype(size_t i) const {
  JointDriveConfig prototype;
  prototype.profile = drive;
  prototype.watchdog_s = watchdog_s;
  prototype.bring_up_attempts = bring_up_attempts;
  prototype.odrive = odrive;
  prototype.mit = mit;
  prototype.cia402 = cia402;
  prototype.moteus = moteus;
  prototype.node_id = static_cast<int>(i) + 1;
  const Eigen::Index known = torque_limit_Nm.size();
  const auto own = known == 1 ? 0 : static_cast<Eigen::Index>(i);
  prototype.torque_limit_Nm = own < known ? torque_limit_Nm[own] : std::numeric_limits<double>::quiet_NaN();
  return prototype;
}

PlanarArmConfig PlanarArmOf(const ArmLayout& layout) {
  PlanarArmConfig arm = layout.arm;
  arm.dof = static_cast<int>(layout.link.size());
  std::copy(layout.link.begin(), layout.link.end(), arm.links.begin());
  arm.obstacle_count = static_cast<int>(layout.obstacle.size());
  std::copy(layout.obstacle.begin(), layout.obstacle.end(), arm.obstacles.begin());
  for (JointVector* limits : {&arm.q_min_rad, &arm.q_max_rad}) {
    if (limits->size() == 1) *limits = JointVector::Constant(arm.dof, (*limits)[0]);
  }
  return arm;
}

FleetConfig FleetOf(const FleetLayout& layout, const std::string& file) {
  FleetConfig fleet;
  fleet.name = layout.name;
  fleet.file = file;
  fleet.timing = layout.timing;
  fleet.estimator = layout.estimator;
  fleet.link = layout.link;
  if (fleet.link.has_key()) {
    const auto folder = std::filesystem::absolute(file).parent_path();
    fleet.link.key_file = (folder / fleet.link.key_file).lexically_normal().string();
  }
  std::transform(layout.arm.begin(), layout.arm.end(), std::back_inserter(fleet.arms), EntryOf);
  for (const GraphLayout& graph : layout.graph) {
    fleet.topologies.push_back(
        {{graph.edges.begin(), graph.edges.end()}, {graph.pins.begin(), graph.pins.end()}});
  }
  fleet.topology_period_s = layout.topology_period_s;
  return fleet;
}

FleetLayout LayoutOf(const FleetConfig& fleet) {
  FleetLayout layout;
  layout.name = fleet.name;
  layout.topology_period_s = fleet.topology_period_s;
  layout.timing = fleet.timing;
  layout.estimator = fleet.estimator;
  layout.link = fleet.link;
  layout.each_arm_has_all_control = true;
  std::transform(fleet.arms.begin(), fleet.arms.end(), std::back_inserter(layout.arm), ArmLayoutOf);
  for (const Topology& topology : fleet.topologies) {
    GraphLayout& graph = layout.graph.emplace_back();
    for (const Pin& pin : topology.pins) graph.pins.push_back({pin});
    for (const Edge& edge : topology.edges) graph.edges.push_back({edge});
  }
  return layout;
}

}  // namespace armada
