#include "host/floor/moving_arm.h"

#include <algorithm>
#include <cmath>

#include "hil/same_instant.h"

namespace armada {

bool HeldDisturbance::Renew(double t_s, const PlanarPlant& plant) {
  const double until_s = NextChange(t_s);
  if (until_s == until_s_ && std::isfinite(until_s)) return false;
  until_s_ = until_s;
  value_Nm_ = disturbance_.At(t_s, plant, leader_);
  deviation_Nm = {};
  return true;
}

PlanarPlant::Joints HeldDisturbance::At(double t_s, const PlanarPlant& plant) {
  const double until_s = NextChange(t_s);
  if (until_s != until_s_) {
    Renew(t_s, plant);
  } else if (std::isinf(until_s)) {
    value_Nm_ = disturbance_.At(t_s, plant, leader_);
  }
  PlanarPlant::Joints d_Nm{};
  for (size_t i = 0; i < d_Nm.size(); ++i) d_Nm[i] = value_Nm_[i] + deviation_Nm[i];
  return d_Nm;
}

void MovingArm::AdvanceTo(double end_s, const PlanarPlant::Joints& tau_Nm, double step_s) {
  while (t_s < end_s) {
    const double next_s = std::min(end_s, disturbance.NextChange(t_s));
    const double step_end_s = next_s - t_s > step_s + kSameInstant_s ? t_s + step_s : next_s;
    if (step_end_s - t_s > kSameInstant_s) {
      PlanarPlant::Joints net_Nm = disturbance.At(t_s, plant);
      for (size_t i = 0; i < net_Nm.size(); ++i) net_Nm[i] = tau_Nm[i] - net_Nm[i];
      plant.Step(net_Nm, step_end_s - t_s);
    }
    t_s = step_end_s;
  }
}

void MovingArm::AdvanceTo(double end_s, const DelayedTorques& torques, double step_s) {
  while (t_s < end_s) AdvanceTo(std::min(end_s, torques.NextChange(t_s)), torques.At(t_s), step_s);
}

}  // namespace armada
