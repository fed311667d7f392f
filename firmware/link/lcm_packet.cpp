#include "firmware/link/lcm_packet.h"

#include <algorithm>
#include <array>

namespace armada {
namespace {

constexpr std::array<uint8_t, 4> kMagic = {'L', 'C', '0', '2'};

}  // namespace

std::optional<LcmPacket> ParseLcmPacket(std::span<const uint8_t> datagram) {
  if (datagram.size() < kLcmHeaderSize) return std::nullopt;
  if (!std::equal(kMagic.begin(), kMagic.end(), datagram.begin())) return std::nullopt;

  const auto body = datagram.subspan(kLcmHeaderSize);
  const auto searched = body.first(std::min(body.size(), kMaxLcmChannel + 1));
  const auto nul = std::find(searched.begin(), searched.end(), uint8_t{0});
  if (nul == searched.end() || nul == searched.begin()) return std::nullopt;

  const auto length = static_cast<size_t>(nul - searched.begin());
  return LcmPacket{{reinterpret_cast<const char*>(body.data()), length}, body.subspan(length + 1)};
}

size_t WriteLcmPacket(uint32_t sequence, const LcmPacket& packet, std::span<uint8_t> out) {
  const std::string_view channel = packet.channel;
  if (channel.empty() || channel.size() > kMaxLcmChannel) return 0;
  if (channel.find('\0') != std::string_view::npos) return 0;
  const size_t overhead = kLcmHeaderSize + channel.size() + 1;
  if (out.size() < overhead || out.size() - overhead < packet.payload.size()) return 0;

  auto next = std::copy(kMagic.begin(), kMagic.end(), out.begin());
  for (const int shift : {24, 16, 8, 0}) *next++ = static_cast<uint8_t>(sequence >> shift);
  next = std::copy(channel.begin(), channel.end(), next);
  *next++ = 0;
  std::copy(packet.payload.begin(), packet.payload.end(), next);
  return overhead + packet.payload.size();
}

}  // namespace armada
