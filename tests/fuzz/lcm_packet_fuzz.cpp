#include <algorithm>
#include <array>

#include "firmware/link/lcm_packet.h"
#include "tests/fuzz/require.h"

namespace armada {
namespace {

/// Datagrams of LCM: what is read lies within the datagram, and written again gives its bytes.
void TestDatagram(std::span<const uint8_t> datagram) {
  const std::optional<LcmPacket> packet = ParseLcmPacket(datagram);
  if (!packet) return;
  Require(!packet->channel.empty() && packet->channel.size() <= kMaxLcmChannel, "a channel's length");
  const size_t overhead = kLcmHeaderSize + packet->channel.size() + 1;
  Require(packet->payload.size() + overhead == datagram.size(), "the payload is the rest of the datagram");

  uint32_t sequence = 0;
  for (size_t i = 4; i < kLcmHeaderSize; ++i) sequence = sequence << 8 | datagram[i];
  static std::array<uint8_t, 1 << 16> buffer;
  const size_t size = WriteLcmPacket(sequence, *packet, buffer);
  Require(std::equal(datagram.begin(), datagram.end(), buffer.begin(), buffer.begin() + size),
          "writing what was read gives the same bytes");
  const auto too_small = std::span(buffer).first(datagram.size() - 1);
  Require(WriteLcmPacket(sequence, *packet, too_small) == 0, "nothing is written where it does not fit");
}

}  // namespace
}  // namespace armada

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  armada::TestDatagram({data, size});
  return 0;
}
