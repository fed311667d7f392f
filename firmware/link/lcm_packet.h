#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace armada {

/// A short message of LCM: one datagram of be32 "LC02", be32 sequence, channel, NUL, payload.
struct LcmPacket {
  std::string_view channel;
  std::span<const uint8_t> payload;
};

inline constexpr size_t kLcmHeaderSize = 8;
inline constexpr size_t kMaxLcmChannel = 63;  ///< characters; liblcm's limit

/// Reads a datagram; the result points into it. Nothing when it is not a short message with a NUL-terminated
/// channel of 1 to kMaxLcmChannel characters: fragments of long messages ("LC03") are refused, too.
std::optional<LcmPacket> ParseLcmPacket(std::span<const uint8_t> datagram);

/// Writes a datagram and returns its size; 0 when the channel is empty, too long or holds a NUL, or when
/// `out` is too small.
size_t WriteLcmPacket(uint32_t sequence, const LcmPacket& packet, std::span<uint8_t> out);

}  // namespace armada
