#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "firmware/core/types.h"
#include "firmware/link/fleet_key.h"
#include "firmware/link/messages.h"

namespace armada {

// A seal proves that a message is of the sender whose channel it has, and newer than all before. It stands
// behind the payload, where LCM's decoders do not look:
//
//   be64 epoch, be64 count, 16 bytes BLAKE2b(sender's key; epoch, count, u8 size of channel, channel,
//   payload)
//
// The epoch counts the starts of the sender and the count its messages since, so that together they only ever
// grow. A sender's key is derived from the fleet's, see DeriveKey.

inline constexpr size_t kSealTagSize = 16;
inline constexpr size_t kSealSize = 16 + kSealTagSize;

/// As whom a process speaks, and in which of its starts.
struct LinkIdentity {
  FleetKey key;
  uint64_t epoch = 0;
};

/// The leader's number as a sender; an arm's is its id.
inline constexpr int kLeaderSender = 0;
/// Whoever gives commands: no arm's.
inline constexpr int kOperatorSender = kMaxArms + 1;

/// Seals what one sender publishes. No heap.
class Sealer {
 public:
  Sealer(const LinkIdentity& identity, int sender);

  /// Puts a seal behind a message that stands at the start of `buffer`, and returns both.
  /// @pre there is room for kSealSize bytes.
  std::span<const uint8_t> Seal(std::string_view channel, std::span<const uint8_t> message,
                                MessageBuffer* buffer);

 private:
  FleetKey key_;
  uint64_t epoch_;
  uint64_t count_ = 0;
};

/// With a sealer, the message sealed; without one, in a fleet that has no key, as it is.
inline std::span<const uint8_t> SealIfKeyed(std::optional<Sealer>& sealer, std::string_view channel,
                                            std::span<const uint8_t> message, MessageBuffer* buffer) {
  return sealer ? sealer->Seal(channel, message, buffer) : message;
}

enum class SealVerdict {
  kGenuine,   ///< of this sender, and newer than every message before
  kForged,    ///< no seal, or not this sender's over this channel and payload
  kReplayed,  ///< genuine once, but not newer than the last one: repeated, or overtaken
};

/// Checks the seals on one channel of one sender. No heap.
class SealCheck {
 public:
  SealCheck(const FleetKey& fleet_key, int sender);

  /// Judges a message. If it is genuine, `*message` is without its seal afterwards, and older ones will be
  /// refused.
  SealVerdict Open(std::string_view channel, std::span<const uint8_t>* message);

 private:
  FleetKey key_;
  uint64_t epoch_ = 0;
  uint64_t count_ = 0;
};

}  // namespace armada
