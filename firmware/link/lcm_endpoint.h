#pragma once

#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/uio.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <ctime>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "firmware/clock/clock.h"
#include "firmware/link/arrival_clock.h"
#include "firmware/link/lcm_message.h"
#include "firmware/link/lcm_url.h"

namespace armada {

struct LcmCounters {
  uint64_t sent = 0;
  uint64_t send_failures = 0;  ///< refused by Publish or by the kernel
  uint64_t received = 0;       ///< well-formed messages, of any channel
  uint64_t malformed = 0;      ///< datagrams that are no short message
  uint64_t overflowed = 0;  ///< datagrams the kernel dropped: longer than kMaxDatagram, or the queue was full
};

/// LCM's short messages on one non-blocking multicast socket, for a real-time loop: no thread, and no heap
/// after Open. It interoperates with liblcm both ways. One thread uses one object.
///
/// Every process of the host gets every message, the sender included: a caller drops its own by their
/// channel.
///
/// Junk costs a bounded time and no memory. The kernel's queue is kept so short that one Drain empties it
/// even when it is full of the smallest datagrams, so that messages never get older than a tick under a
/// storm; what the queue cannot hold is dropped and counted.
class LcmEndpoint {
 public:
  /// One Ethernet frame's worth: what boards send is never fragmented.
  static constexpr size_t kMaxDatagram = 1472;
  /// Datagrams one Drain takes at most.
  static constexpr int kMaxPerDrain = 640;

  /// Joins the group. `clock` outlives the object. On failure returns nothing and sets `*error` to the reason
  /// and what to do. Start-up only.
  static std::unique_ptr<LcmEndpoint> Open(const LcmUrl& url, Clock* clock, std::string* error);

  LcmEndpoint(const LcmEndpoint&) = delete;
  LcmEndpoint& operator=(const LcmEndpoint&) = delete;
  ~LcmEndpoint();

  /// Sends one message; false when it was not sent: the kernel refused it, the channel is not 1 to 63
  /// characters, or the datagram is over kMaxDatagram.
  bool Publish(std::string_view channel, std::span<const uint8_t> payload);

  /// Calls `handler(const LcmMessage&)` for every message waiting, in order of arrival, and returns the
  /// number of datagrams taken, at most `max`. Never blocks.
  template <class Handler>
  int Drain(Handler&& handler, int max = kMaxPerDrain) {
    int taken = 0;
    while (taken < max) {
      const int wanted = std::min(max - taken, kBatch);
      const int got = ReceiveBatch(wanted);
      for (int i = 0; i < got; ++i) {
        if (const auto message = Read(i)) handler(*message);
      }
      taken += got;
      if (got < wanted && !clock_->MoreToCome(socket_)) break;
    }
    return taken;
  }

  /// Descriptor to poll for input.
  int descriptor() const { return socket_; }

  const LcmCounters& counters() const { return counters_; }

 private:
  static constexpr int kBatch = 32;

  struct Slot {
    std::array<uint8_t, kMaxDatagram> datagram;
    alignas(cmsghdr) std::array<uint8_t, CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(uint32_t))> control;
    iovec part;
  };

  LcmEndpoint(int socket, const sockaddr_in& group, Clock* clock);

  /// Takes up to `wanted` datagrams into the slots and returns their number.
  int ReceiveBatch(int wanted);
  /// The message in a slot, unless it is to be ignored; counts it.
  std::optional<LcmMessage> Read(int index);
  /// Arrival on the monotonic clock; takes note of the kernel's drop count.
  int64_t ReadControl(msghdr* header);
  void CompareClocks();

  int socket_;
  sockaddr_in group_;
  Clock* clock_;
  uint32_t sequence_ = 0;
  ArrivalClock arrival_;
  LcmCounters counters_;
  std::array<Slot, kBatch> slots_{};
  std::array<mmsghdr, kBatch> headers_{};
};

}  // namespace armada
