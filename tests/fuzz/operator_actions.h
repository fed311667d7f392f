#pragma once

#include <cstdint>

namespace armada {

/// What an input of the fuzzer `operator` tells to do: a byte, then the bytes that the action reads.
enum class OperatorAction : uint8_t {
  kTicks,    ///< periods pass: 1 byte, how many
  kCommand,  ///< the operator gives a command: 1 byte, which
  kWrong,   ///< a command with anything in it, under the operator's seal: 1 byte request, 1 byte arm, 2 bytes
            ///< by how many ms the stamp quoted is off, 1 byte whether the fleet file is another one
  kRepeat,  ///< a command of before, again: 1 byte, which one
  kDamage,  ///< the same with one bit changed: 2 bytes more, which bit
  kForeign,  ///< a command under another key: 1 byte, which
  kNoSeal,   ///< a command without a seal: 1 byte, which
  kLeader,   ///< the leader falls silent, or speaks again
  kDrives,   ///< frames of the drives are lost, or come again
  kCount,
};

}  // namespace armada
