#include "hil/disturbance.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "hil/random.h"

namespace armada {
namespace {

// Index of the hold interval that contains t, robust against rounding at its start.
double Interval(double t_s, double hold_s) {
  return std::floor(t_s / hold_s + 1e-6);
}

// Sign of J' (x - x_0) by joint: the torque direction that pushes the end effector away from the leader.
PlanarPlant::Joints AwayFromLeader(const PlanarPlant& plant, const Zeta& leader) {
  const PlanarArmConfig& arm = plant.config();
  const size_t n = static_cast<size_t>(plant.dof());
  const PlanarPlant::Tip tip = plant.EndEffector();
  const double ex = tip.x_m[0] - leader.x_m[0];
  const double ey = tip.x_m[1] - leader.x_m[1];
  PlanarPlant::Joints sign{};
  double angle = arm.base_orientation_rad;
  double joint_x = arm.base_x_m;
  double joint_y = arm.base_y_m;
  for (size_t i = 0; i < n; ++i) {
    const double moment = -(tip.x_m[1] - joint_y) * ex + (tip.x_m[0] - joint_x) * ey;
    sign[i] = moment > 0.0 ? 1.0 : moment < 0.0 ? -1.0 : 0.0;
    angle += plant.q_rad[i];
    joint_x += arm.links[i].l_m * std::cos(angle);
    joint_y += arm.links[i].l_m * std::sin(angle);
  }
  return sign;
}

}  // namespace

PlanarPlant::Joints Disturbance::At(double t_s, const PlanarPlant& plant, const LeaderPath* leader) const {
  PlanarPlant::Joints d_Nm{};
  if (config_.kind == DisturbanceKind::kNone) return d_Nm;
  if (config_.kind == DisturbanceKind::kAdversarial) {
    if (leader == nullptr) return d_Nm;
    d_Nm = AwayFromLeader(plant, leader->At(t_s));  // enters as H ddq + .. + d = u
    for (double& d_i : d_Nm) d_i *= -config_.amplitude_Nm;
    return d_Nm;
  }
  const auto interval = static_cast<uint64_t>(static_cast<int64_t>(Interval(t_s, config_.hold_s)));
  for (size_t i = 0; i < static_cast<size_t>(plant.dof()); ++i) {
    const double joint = static_cast<double>(i);
    switch (config_.kind) {
      case DisturbanceKind::kUniform: {
        const uint64_t place = static_cast<uint64_t>(arm_id_) * kMaxDof + i;
        d_Nm[i] = Uniform(RandomBits(seed_, kDisturbanceStream, place, interval), -config_.amplitude_Nm,
                          config_.amplitude_Nm);
        break;
      }
      case DisturbanceKind::kSine:
        d_Nm[i] = config_.amplitude_Nm *
                  std::sin(2.0 * std::numbers::pi * (config_.frequency_hz + 0.2 * joint) * t_s + joint);
        break;
      default:
        d_Nm[i] = config_.amplitude_Nm;
        break;
    }
  }
  return d_Nm;
}

double Disturbance::NextChange(double t_s) const {
  if (config_.kind != DisturbanceKind::kUniform && config_.kind != DisturbanceKind::kAdversarial) {
    return std::numeric_limits<double>::infinity();
  }
  return (Interval(t_s, config_.hold_s) + 1.0) * config_.hold_s;
}

}  // namespace armada
