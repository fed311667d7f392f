#pragma once

#include "hil/leader_path.h"
#include "hil/planar_plant.h"
#include "hil/scenario.h"

namespace armada {

/// Where an arm begins at t = 0: the plant's joints, and the controller's zeta(0) and theta_hat(0).
struct ArmStart {
  PlanarPlant::Joints q_rad{};
  PlanarPlant::Joints dq_rad_s{};
  ArmInitialState controller;
};

/// Joint angles that put the end effector at `x_m` (as near as the arm reaches), by damped least squares from
/// a bent elbow: always the same of the arm's postures.
JointVector BentElbow(const PlanarArm& arm, const TaskVector& x_m);

/// The start of arm `index` in run `seed`. `leader` may be null in a leaderless scenario.
ArmStart DrawStart(const ScenarioConfig& scenario, size_t index, uint64_t seed, const LeaderPath* leader);

}  // namespace armada
