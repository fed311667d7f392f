#pragma once

#include <vector>

#include "firmware/can/bus.h"
#include "hil/fault.h"

namespace armada {

/// What the scenario's faults do to one arm's board, at a time of the run. Without a fault of its own: always
/// nothing.
class BoardFaults {
 public:
  BoardFaults(const std::vector<FaultConfig>& faults, int arm_id);

  /// Whether the arm has any, also of its drives and its bus.
  bool any() const { return !faults_.empty(); }
  /// There is no controller: it was killed, and is not started again yet.
  bool Kills(double t_s) const;
  /// There is one, but it gets no time.
  bool Stops(double t_s) const { return Holds(FaultKind::kControllerStops, t_s); }
  /// The torques of the tick do not get into the transmit queue.
  bool RefusesTorques(double t_s) const { return Holds(FaultKind::kQueueFull, t_s); }
  /// What the board's bus says in the tick that comes one period after the last.
  BusStatus BusAt(double t_s, double period_s) const;
  /// How long the controller computes in a tick.
  double ComputeTime_s(double t_s) const;

 private:
  bool Holds(FaultKind kind, double t_s) const { return FindActive(faults_, kind, arm_id_, t_s) != nullptr; }

  int arm_id_;
  std::vector<FaultConfig> faults_;  ///< of this arm
};

}  // namespace armada
