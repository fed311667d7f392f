#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "firmware/link/messages.h"
#include "firmware/link/seal.h"
#include "host/fault/group_socket.h"

namespace armada {

/// What somebody without the fleet's key can send to it.
enum class JunkKind : int {
  kRandom,         ///< any bytes
  kShortHeader,    ///< less than LCM's header
  kUnterminated,   ///< a channel's name without an end
  kFragment,       ///< of a long message: with offsets and counts beyond it, and never all of it
  kOversized,      ///< beyond what boards take, up to 8 kB
  kLarge,          ///< as large as an Ethernet frame, on a channel that nobody knows
  kRandomPayload,  ///< any bytes on one of the fleet's channels
  kReplayed,       ///< a message of the fleet, again
  kReordered,      ///< the last two of a channel, the newer one first
  kDamaged,        ///< one with a bit changed
  kNonfinite,      ///< one with a position that is no number
  kForged,         ///< the next one of a sender, a little off, sealed with another key
  kEstop,          ///< an e-stop for every arm, sealed with another key
};
inline constexpr int kJunkKinds = 13;
const char* NameOf(JunkKind kind);

/// Somebody on the fleet's network who has not its key: listens, and sends what the fleet must not take.
class Stranger {
 public:
  Stranger(GroupSocket socket, uint64_t seed);

  /// Keeps what the fleet has sent since, as far as it can be of use.
  void Listen();
  bool has_heard_a_board() const;

  /// Sends something of this kind; nothing of a kind that wants a message of the fleet before there is one.
  void Send(JunkKind kind);

  int64_t sent(JunkKind kind) const { return sent_[static_cast<size_t>(kind)]; }
  /// What was well-formed LCM on a channel of the fleet.
  const std::map<std::string, int64_t>& sent_on() const { return sent_on_; }

 private:
  using Bytes = std::vector<uint8_t>;
  /// The last two messages of a channel, the older one first.
  struct Recording {
    std::string channel;
    std::vector<Bytes> payloads;
  };

  uint64_t Below(uint64_t end) { return random_() % end; }
  Bytes RandomBytes(size_t size);
  Recording& AnyRecording() { return heard_[Below(heard_.size())]; }
  Bytes Fragment();
  void Count(JunkKind kind) { ++sent_[static_cast<size_t>(kind)]; }
  void SendRaw(JunkKind kind, const Bytes& datagram);
  void SendOn(JunkKind kind, const std::string& channel, std::span<const uint8_t> payload);
  void SendHeard(JunkKind kind);
  void SendDamaged(const Recording& recording);
  void SendEstop();
  template <class Message>
  bool SendChanged(JunkKind kind, const Recording& recording);

  GroupSocket socket_;
  std::mt19937_64 random_;
  FleetKey own_key_{};
  uint32_t sequence_ = 0;
  std::vector<Recording> heard_;  ///< one a channel
  std::array<int64_t, kJunkKinds> sent_{};
  std::map<std::string, int64_t> sent_on_;
};

}  // namespace armada
