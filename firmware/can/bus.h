#pragma once

#include <cstdint>

#include "firmware/can/frame.h"

namespace armada {

/// What a bus operation came to. Every value must be handled by the caller.
enum class BusStatus {
  kOk,
  kTimeout,    ///< nothing received before the deadline
  kQueueFull,  ///< the frame was dropped, not queued: an old torque is never sent late
  kDown,       ///< the interface or the socket is gone
};

struct BusCounters {
  uint64_t sent = 0;
  uint64_t received = 0;
  uint64_t dropped_queue_full = 0;  ///< frames refused by a full transmit queue
  uint64_t malformed = 0;           ///< datagrams or frames that do not parse; ignored
  uint64_t errors = 0;              ///< error frames seen
};

/// A CAN bus as the 100 Hz loop sees it: no call allocates, Send never blocks, Receive blocks no longer than
/// its deadline. Implementations own their descriptor, and one thread uses one object.
class CanBus {
 public:
  CanBus() = default;
  CanBus(const CanBus&) = delete;
  CanBus& operator=(const CanBus&) = delete;
  virtual ~CanBus() = default;

  /// Sends one frame, now or never. A frame that is not IsValid() is a fault of the caller: it is not sent,
  /// counted as malformed, and answered with kQueueFull, since like one it is dropped.
  virtual BusStatus Send(const CanFrame& frame) = 0;

  /// Waits for the next frame of another node until `deadline_ns` (CLOCK_MONOTONIC); a deadline in the past
  /// polls. Error frames are counted and handed over like any other. `frame` is written only with kOk.
  virtual BusStatus Receive(int64_t deadline_ns, CanFrame* frame) = 0;

  /// Descriptor to poll for input.
  virtual int descriptor() const = 0;

  const BusCounters& counters() const { return counters_; }

 protected:
  BusCounters counters_;
};

}  // namespace armada
