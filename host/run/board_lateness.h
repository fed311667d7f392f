#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "firmware/core/arm_controller.h"
#include "firmware/link/messages.h"

namespace armada {

/// What was late or lost on one board in a part of a run, as its telemetry tells. Durations are the largest
/// ones; each time is that of the tick that tells.
struct BoardLateness {
  struct Largest {
    double value = 0.0;
    double at_s = 0.0;
  };
  int64_t missed_ticks = 0;
  double missed_at_s = 0.0;    ///< of the most at once
  Largest wakeup_s;            ///< how late it woke
  Largest sample_to_torque_s;  ///< from the request for samples to the last torque on the wire
  Largest silent_s;            ///< without a tick of it, be it heard, missed or lost on the way here
  int64_t can_dropped = 0;
  int64_t lcm_rejected = 0;

  /// For people, with what is tolerable left out; empty when nothing was late or lost.
  std::string Text(const TimingConfig& timing) const;
};

/// `ticks`: of one board, in order. @pre from_s <= to_s, times of the run, which began at `epoch_ns`.
BoardLateness LatenessBetween(std::span<const telemetry_t> ticks, double period_s, int64_t epoch_ns,
                              double from_s, double to_s);

/// Lateness from which on something is lost: a tick waits no longer for samples, or for its torques to be on
/// the wire.
double TolerableLateness_s(const TimingConfig& timing);

}  // namespace armada
