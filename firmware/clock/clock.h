#pragma once

#include <netinet/in.h>
#include <poll.h>

#include <cstdint>
#include <ctime>
#include <span>

namespace armada {

/// A process's time, and all its waiting. Buses, endpoints and loops have no other: what they do is the same
/// on the machine's clock and on that of a run in stepped time. One thread uses one object; no call
/// allocates.
class Clock {
 public:
  Clock() = default;
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;
  virtual ~Clock() = default;

  /// Whether time stands while programs compute. What the machine does to a program meanwhile, page faults
  /// say, is not of such a run.
  virtual bool IsStepped() const { return false; }

  /// CLOCK_MONOTONIC, ns: the only time of the control path.
  virtual int64_t Now() const = 0;

  /// CLOCK_REALTIME, ns: for logs and for comparing with the kernel's stamps.
  virtual int64_t WallNow() const = 0;

  /// Waits until `deadline_ns`; may return earlier when a signal comes.
  virtual void SleepUntil(int64_t deadline_ns) = 0;

  /// Waits until one of `inputs` has something, and says so in their `revents`, or until `deadline_ns`; may
  /// return earlier when a signal comes.
  virtual void Wait(std::span<pollfd> inputs, int64_t deadline_ns) = 0;

  // Stepped time stands while a datagram of the run is unread, so it is told of each. The machine's clock
  // only reads the kernel's stamps.

  /// `descriptor` receives what is sent to a multicast group from now on. Start-up only.
  virtual void Joined(int /*descriptor*/, const sockaddr_in& /*group*/) {}
  /// This process has sent a datagram to a group.
  virtual void Sent(const sockaddr_in& /*group*/) {}
  /// One datagram was read, of any sender: when it came, on WallNow's clock. Once for each, in their order.
  virtual int64_t ArrivalOf(int descriptor, const timespec& kernel_stamp) = 0;
  /// There was nothing to read. True: read again, one more is to come.
  virtual bool MoreToCome(int /*descriptor*/) { return false; }
};

}  // namespace armada
