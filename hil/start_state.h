#pragma once

#include <array>

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

/// Joint angles of an arm with its elbows bent, the tip somewhere.
JointVector BentElbow(const PlanarArm& arm);

/// Joint angles that put the end effector at `x_m`, or as near as the arm reaches, by damped least squares
/// from `q_rad`: a posture like that one.
JointVector ReachFrom(const PlanarArm& arm, JointVector q_rad, const TaskVector& x_m);

/// Largest error on any axis that zeta(0) of x (m), v (m/s) and a (m/s^2) can have.
std::array<double, 3> LargestStartErrors(const StartConfig& start, const LeaderPath& leader);

/// The start of arm `index` in run `seed`. `leader` may be null in a leaderless scenario.
ArmStart DrawStart(const ScenarioConfig& scenario, size_t index, uint64_t seed, const LeaderPath* leader);

}  // namespace armada
