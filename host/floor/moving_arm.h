#pragma once

#include "hil/delayed_torque.h"
#include "hil/disturbance.h"

namespace armada {

using DelayedTorques = DelayedTorque<PlanarPlant::Joints>;

/// The disturbance of one arm as the bench applies it: evaluated when a held value begins, at every step of
/// the integration where none is held.
class HeldDisturbance {
 public:
  HeldDisturbance(const Disturbance& disturbance, const LeaderPath& leader)
      : disturbance_(disturbance), leader_(&leader) {}

  /// Value from `t_s` on.
  PlanarPlant::Joints At(double t_s, const PlanarPlant& plant);
  /// Takes up the value of `t_s`, without a deviation, where that is not of the interval that went before, or
  /// where none is held. False where the value goes on.
  bool Renew(double t_s, const PlanarPlant& plant);
  double NextChange(double t_s) const { return disturbance_.NextChange(t_s); }

  /// What is added to the value until the next one begins: what a filter has learnt of it.
  PlanarPlant::Joints deviation_Nm{};

 private:
  Disturbance disturbance_;
  const LeaderPath* leader_;
  PlanarPlant::Joints value_Nm_{};
  double until_s_ = 0.0;  ///< end of the interval that the value is held for
};

/// Largest integration step where a controller looks for a torque or for a sensitivity: RK4 is right to much
/// less than a micrometre there.
inline constexpr double kSearchStep_s = 0.005;

/// An arm under torque and disturbance. The true one moves as the emulated bench does (hil/emulated_arm.h)
/// between the same events; what a controller believes of it is another one, and predictions are copies of
/// that.
struct MovingArm {
  PlanarPlant plant;
  HeldDisturbance disturbance;
  double t_s = 0.0;

  /// Moves on under a constant torque, in steps of at most `step_s`.
  void AdvanceTo(double end_s, const PlanarPlant::Joints& tau_Nm, double step_s);
  /// Moves on under the drives' torques.
  void AdvanceTo(double end_s, const DelayedTorques& torques, double step_s);
};

}  // namespace armada
