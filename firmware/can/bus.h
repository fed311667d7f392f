#pragma once

#include <cstdint>

#include "firmware/can/frame.h"

namespace armada {

/// What a bus operation came to. Every value must be handled by the caller.
enum class [[nodiscard]] BusStatus{
    kOk,
    kTimeout,       ///< nothing received, or not everything sent, before the deadline
    kQueueFull,     ///< the frame was dropped, not queued: an old torque is never sent late
    kErrorPassive,  ///< the controller has counted so many errors that it may no longer disturb the bus: a
                    ///< warning
    kErrorActive,   ///< it no longer is
    kBusOff,        ///< the controller has left the bus; nothing is sent or received any more
    kRestarted,  ///< the controller was restarted after bus-off; drives may have lost their master meanwhile
    kDown,       ///< the interface or the socket is gone
};

struct BusCounters {
  uint64_t sent = 0;                ///< frames on the wire, or handed over where nothing can prove more
  uint64_t received = 0;            ///< frames of other nodes
  uint64_t replaced = 0;            ///< torques that a newer one overtook while they waited
  uint64_t dropped_queue_full = 0;  ///< frames refused by a full transmit queue
  uint64_t dropped_late = 0;        ///< frames that still waited at their deadline, and were not sent
  uint64_t malformed = 0;           ///< datagrams or frames that do not parse; ignored
  uint64_t receive_overflowed = 0;  ///< frames that came faster than they were taken, and were lost
  uint64_t errors = 0;              ///< error frames seen
  uint64_t error_passive = 0;       ///< times the controller became error-passive
  uint64_t bus_off = 0;             ///< times it left the bus
  uint64_t restarts = 0;            ///< times it was restarted
};

/// A CAN bus as the 100 Hz loop sees it: no call allocates, Send never blocks, Receive and Flush block no
/// longer than their deadline. Implementations own their descriptor, and one thread uses one object.
class CanBus {
 public:
  CanBus() = default;
  CanBus(const CanBus&) = delete;
  CanBus& operator=(const CanBus&) = delete;
  virtual ~CanBus() = default;

  /// Takes one frame to send, in order. Where the bus is busy the frame waits in a short queue of ours, in
  /// which a newer `latest_only` frame takes the place of an older one with its identifier; Receive and Flush
  /// send on. A frame that is not IsValid(), or that this bus cannot carry, is a fault of the caller: it is
  /// not sent, counted as malformed, and answered with kQueueFull, since like one it is dropped.
  virtual BusStatus Send(const CanFrame& frame) = 0;

  /// Waits until every frame that Send took is on the wire. Those that still wait for it at `deadline_ns`
  /// (CLOCK_MONOTONIC) are dropped, not sent late: kTimeout.
  virtual BusStatus Flush(int64_t deadline_ns) = 0;

  /// Forgets frames that wait to be sent: what comes next must not queue behind old torques.
  virtual void DropWaiting() = 0;

  /// Waits for the next frame of another node until `deadline_ns` (CLOCK_MONOTONIC); a deadline in the past
  /// polls. Error frames are counted; those that tell of a change of the controller's state come back as that
  /// status, others are handed over like any frame. `frame` is written only with kOk.
  virtual BusStatus Receive(int64_t deadline_ns, CanFrame* frame) = 0;

  /// Descriptor to poll for input.
  virtual int descriptor() const = 0;

  const BusCounters& counters() const { return counters_; }

 protected:
  BusCounters counters_;
};

}  // namespace armada
