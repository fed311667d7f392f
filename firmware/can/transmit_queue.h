#pragma once

#include <array>
#include <cstddef>

#include "firmware/can/frame.h"

namespace armada {

/// Frames on their way to a CAN controller. What is handed to the kernel cannot be called back, so only a few
/// are at a time: the rest waits here, in order, and a torque that waits is overtaken by a newer one for the
/// same drive. An echo from the wire confirms each frame and makes room for the next.
class TransmitQueue {
 public:
  static constexpr size_t kCapacity = 64;  ///< more than one arm's busiest tick

  enum class Taken { kQueued, kReplaced, kFull };

  /// `window`: most frames handed over and not confirmed, 1 to kCapacity.
  explicit TransmitQueue(size_t window) : window_(window) {}

  Taken Push(const CanFrame& frame);

  /// The frame to hand over now; null when none waits or the window is full.
  const CanFrame* Next() const;
  /// The frame of Next() is with the kernel.
  void HandedOver();
  /// The frame of Next() was refused, and is dropped.
  void Refused();
  /// An echo has come; true when it was of a frame in flight.
  bool Confirm(const CanFrame& echo);

  /// Drops what waits; returns how many.
  size_t DropWaiting();
  /// The controller has lost what was in flight.
  void ForgetInFlight() { in_flight_count_ = 0; }

  size_t waiting() const { return waiting_count_; }
  size_t in_flight() const { return in_flight_count_; }

 private:
  void RemoveFirst();

  size_t window_;
  std::array<CanFrame, kCapacity> waiting_{};
  size_t waiting_count_ = 0;
  std::array<uint32_t, kCapacity> in_flight_{};  ///< identifiers, oldest first
  size_t in_flight_count_ = 0;
};

}  // namespace armada
