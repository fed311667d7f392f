#pragma once

#include "hil/leader_path.h"
#include "hil/planar_plant.h"
#include "hil/scenario.h"

namespace armada {

/// d(t) of (1.1) for one arm. Every kind is bounded by the amplitude in each joint and depends on the seed,
/// the arm and the time alone (adversarial: on the arm's state too).
class Disturbance {
 public:
  Disturbance(const DisturbanceConfig& config, uint64_t seed, int arm_id)
      : config_(config), seed_(seed), arm_id_(arm_id) {}

  /// Value from `t_s`, to be held until NextChange(t_s) where that is finite. `leader` may be null when there
  /// is none.
  PlanarPlant::Joints At(double t_s, const PlanarPlant& plant, const LeaderPath* leader) const;

  /// First time after t_s at which a held value ends; infinity when none is held.
  double NextChange(double t_s) const;

 private:
  DisturbanceConfig config_;
  uint64_t seed_;
  int arm_id_;
};

}  // namespace armada
