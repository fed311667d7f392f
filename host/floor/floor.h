#pragma once

#include <cstdint>
#include <vector>

#include "hil/scenario.h"

namespace armada {

/// The unavoidable error of one arm in one run, over the scenario's window as a run measures it.
struct ArmFloor {
  int id = 0;
  int dof = 0;
  double rms_m = 0.0;
  double max_m = 0.0;
};

/// Of a fleet: docs/floor.md.
struct FloorResult {
  std::vector<ArmFloor> arms;
  double fleet_rms_m = 0.0;  ///< root of the mean over the arms of the squared rms_m
};

/// The error that is left to a controller which knows the plant and the leader and has every torque it wants,
/// under the scenario's disturbance of this seed, its sampling, its latency and its sensors. The same
/// arguments give the same bytes.
/// @pre the scenario has a leader.
FloorResult Floor(const ScenarioConfig& scenario, uint64_t seed);

/// The same with each arm in a posture like the one given: a disturbance's effect depends on it, and spare
/// joints, or where they cannot tell, the start, decide it. `postures_rad` one an arm, of the tick at which
/// the floor begins.
FloorResult Floor(const ScenarioConfig& scenario, uint64_t seed,
                  const std::vector<JointVector>& postures_rad);

/// Control tick at which the floor of a scenario begins, some time before the window.
int64_t FloorStartTick(const ScenarioConfig& scenario);

/// Of several seeds together: the root of the mean of each RMS squared, the largest of each maximum. @pre one
/// or more, of one fleet.
FloorResult Together(const std::vector<FloorResult>& floors);

}  // namespace armada
