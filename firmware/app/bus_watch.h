#pragma once

#include <array>

#include "firmware/can/bus.h"
#include "firmware/core/arm_controller.h"

namespace armada {

/// Watches a board's CAN bus and its own punctuality for causes. What happens between two ticks counts in
/// the second.
class BusWatch {
 public:
  BusWatch(const TimingConfig& timing, const SupervisorConfig& supervisor)
      : timing_(timing), supervisor_(supervisor) {}

  /// What a bus operation came to.
  void OnBus(BusStatus status);
  /// Whether every torque of a tick was on the wire in time.
  void OnSent(bool all);
  /// How late after the tick its torques were ready, and how many ticks before it were missed.
  void OnTick(int64_t tick_ns, double ready_s, int64_t missed);

  /// The causes of this tick.
  CauseSet Take(int64_t tick_ns);

  /// Whether the torques of the last tick were not sent.
  bool loses_torques() const { return unsent_in_a_row_ > 0; }

  /// After a reset by the operator.
  void Reset() { *this = BusWatch(timing_, supervisor_); }

 private:
  TimingConfig timing_;
  SupervisorConfig supervisor_;
  CauseSet new_;
  bool error_passive_ = false;
  double error_passive_s_ = 0.0;
  int unsent_in_a_row_ = 0;
  std::array<int64_t, SupervisorConfig::kMaxMissedInASecond> missed_at_ns_{};  ///< the last ones; 0: none
  size_t next_missed_ = 0;
};

}  // namespace armada
