#pragma once

#include <array>
#include <csignal>

#include "firmware/app/arm_node.h"
#include "firmware/app/duration_histogram.h"
#include "firmware/can/bus.h"
#include "firmware/clock/clock.h"
#include "firmware/link/lcm_endpoint.h"

namespace armada {

/// What one run of the loop came to.
struct LoopReport {
  DurationHistogram wakeup_lateness;
  DurationHistogram compute;           ///< from the last feedback frame to the last torque frame on the wire
  DurationHistogram sample_to_torque;  ///< from the request for samples to the same
  int64_t ticks = 0;
  int64_t missed_ticks = 0;
  int64_t incomplete_samples = 0;  ///< ticks in which a joint's sample did not come in time
  int64_t unsent_ticks = 0;        ///< ticks in which not every torque was on the wire in time
  int64_t heap_allocations = 0;    ///< since the first tick
  int64_t page_faults = 0;         ///< since the first tick
};

/// The 100 Hz loop of one board: absolute deadlines on the grid of the epoch, no catch-up bursts. Allocates
/// and logs nothing after the first tick.
class ArmLoop {
 public:
  /// What is pointed to outlives the object.
  ArmLoop(ArmNode* node, CanBus* bus, LcmEndpoint* link, Clock* clock, const TimingConfig& timing,
          int64_t epoch_ns);

  /// Emulation only: brings the drives up until the epoch. False when one of them is not in torque mode by
  /// then, or on `*stop`.
  bool BringUp(const volatile std::sig_atomic_t* stop);
  /// Runs ticks until `end_ns` or `*stop`, then disables the drives. False when it was stopped.
  bool Run(int64_t end_ns, const volatile std::sig_atomic_t* stop);

  const LoopReport& report() const { return report_; }
  /// The controller's state in the last tick, before the loop put the drives to rest.
  ControllerState final_state() const { return final_state_; }

 private:
  void Tick(int64_t tick_ns, int64_t woken_ns);
  /// Sleeps until then, but for taking what comes meanwhile.
  void ListenUntil(int64_t time_ns);
  void Send();
  /// Waits until the torques are on the wire.
  void ConfirmSent(int64_t deadline_ns);
  /// Takes frames until the samples are complete or the deadline has passed; returns the time at which it had
  /// what it gets.
  int64_t AwaitSamples(int64_t deadline_ns);
  /// Takes what is waiting: heartbeats count, samples from before the request must not.
  void TakeWaitingFrames();
  /// Hears the neighbours and the operator.
  void TakeWaitingMessages();
  void AnswerOperator(int64_t tick_ns);
  void PublishTelemetry();

  ArmNode* node_;
  CanBus* bus_;
  LcmEndpoint* link_;
  Clock* clock_;
  int64_t period_ns_;
  int64_t feedback_timeout_ns_;
  int64_t transmit_timeout_ns_;
  int listens_;
  int64_t epoch_ns_;
  FrameList out_;
  MessageBuffer buffer_{};
  telemetry_t telemetry_{};
  LoopReport report_;
  ControllerState final_state_ = ControllerState::kInit;
  int64_t missed_before_tick_ = 0;
  int64_t heap_at_start_ = 0;
  int64_t faults_at_start_ = 0;
};

}  // namespace armada
