#pragma once

#include <cstdint>

namespace armada {

/// What an input of the fuzzer `link` tells to do: a byte, then the bytes that the action reads.
enum class LinkAction : uint8_t {
  kTick,     ///< one period passes
  kLeader,   ///< the leader says where it is: 2 bytes, by how much it has moved
  kArm,      ///< so does an arm: 2 bytes for the move, 1 for its agreement
  kRepeat,   ///< a message of before, again: 1 byte, which one
  kDamage,   ///< the same with one bit changed: 2 bytes more, which bit
  kNoSeal,   ///< the same without its seal
  kForeign,  ///< the same, sealed by a stranger
  kJunk,     ///< any bytes: 1 byte for the channel, 1 for their number, then they
  kRestart,  ///< the leader starts anew, its clock too
  kCount,
};

}  // namespace armada
