#pragma once

#include <cstdint>
#include <span>

#include "firmware/can/frame.h"
#include "hil/emulated_arm.h"

namespace armada {

/// Looks on while a simulation runs, from outside the boards: what they put on their buses and on the link,
/// and what their arms do. `arm` is the index in the fleet, times are of the run.
class SimulationWatch {
 public:
  virtual ~SimulationWatch() = default;

  /// From here to Leave() the code that runs is the board's own.
  virtual void Enter(size_t arm) = 0;
  virtual void Leave(size_t arm) = 0;
  /// A frame from the board.
  virtual void OnFrame(size_t arm, double t_s, const CanFrame& frame) = 0;
  /// What the board tells its neighbours in a tick.
  virtual void OnEstimate(size_t arm, double t_s, std::span<const uint8_t> payload) = 0;
  /// Every millisecond: the arm on its bench, and how far its end effector is from where it should be.
  virtual void OnMoment(size_t arm, double t_s, const EmulatedArm& bench, double error_m) = 0;
};

}  // namespace armada
