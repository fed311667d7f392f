#include "firmware/link/lcm_packet.h"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <string>
#include <vector>

namespace armada {
namespace {

using Bytes = std::vector<uint8_t>;

// A datagram of the text; the NULs of string literals with a given size count.
template <size_t kSize>
Bytes Datagram(const char (&text)[kSize]) {
  return {text, text + kSize - 1};
}

TEST(LcmPacket, IsMagicSequenceChannelNulAndPayload) {
  const Bytes payload = {0xAA, 0x00, 0xBB};
  std::array<uint8_t, 64> buffer{};
  const size_t size = WriteLcmPacket(0x01020304, {"EST_7", payload}, buffer);
  const Bytes expected = Datagram(
      "LC02\x01\x02\x03\x04"
      "EST_7\0\xAA\0\xBB");
  EXPECT_EQ(Bytes(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(size)), expected);
}

TEST(LcmPacket, ReadsBackWhatWasWritten) {
  std::array<uint8_t, 128> buffer{};
  for (const std::string& channel : {std::string("a"), std::string(kMaxLcmChannel, 'x')}) {
    for (const Bytes& payload : {Bytes{}, Bytes{0}, Bytes(40, 7)}) {
      const size_t size = WriteLcmPacket(9, {channel, payload}, buffer);
      const auto packet = ParseLcmPacket(std::span(buffer).first(size));
      ASSERT_TRUE(packet);
      EXPECT_EQ(packet->channel, channel);
      EXPECT_EQ(Bytes(packet->payload.begin(), packet->payload.end()), payload);
    }
  }
}

TEST(LcmPacket, IsNotWrittenWithABadChannel) {
  std::array<uint8_t, 128> buffer{};
  EXPECT_EQ(WriteLcmPacket(0, {"", {}}, buffer), 0U);
  EXPECT_EQ(WriteLcmPacket(0, {std::string(kMaxLcmChannel + 1, 'x'), {}}, buffer), 0U);
  EXPECT_EQ(WriteLcmPacket(0, {std::string_view("a\0b", 3), {}}, buffer), 0U);
}

TEST(LcmPacket, IsNotWrittenPastTheBuffer) {
  const Bytes payload(10, 1);
  std::array<uint8_t, 32> buffer{};
  const size_t needed = kLcmHeaderSize + 2 + payload.size();
  for (size_t size = 0; size <= buffer.size(); ++size) {
    EXPECT_EQ(WriteLcmPacket(0, {"a", payload}, std::span(buffer).first(size)), size < needed ? 0 : needed)
        << size;
  }
}

TEST(LcmPacket, IsRefusedWhenMalformed) {
  EXPECT_TRUE(ParseLcmPacket(Datagram("LC02\0\0\0\0a\0")));
  EXPECT_FALSE(ParseLcmPacket({}));
  EXPECT_FALSE(ParseLcmPacket(Datagram("LC02")));
  EXPECT_FALSE(ParseLcmPacket(Datagram("LC02\0\0\0\0")));
  EXPECT_FALSE(ParseLcmPacket(Datagram("LC02\0\0\0\0\0payload")));
  EXPECT_FALSE(ParseLcmPacket(Datagram("LC02\0\0\0\0channel without an end")));
  EXPECT_FALSE(ParseLcmPacket(Datagram("LC03\0\0\0\0a\0")));
  EXPECT_FALSE(ParseLcmPacket(Datagram("LC01\0\0\0\0a\0")));

  Bytes long_channel = Datagram("LC02\0\0\0\0");
  long_channel.insert(long_channel.end(), kMaxLcmChannel + 1, 'x');
  long_channel.push_back(0);
  EXPECT_FALSE(ParseLcmPacket(long_channel));
}

TEST(LcmPacket, OfRandomBytesStaysInsideTheDatagram) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 20'000; ++trial) {
    // Exactly as long as the heap block, so that the sanitizer sees a read past the end.
    Bytes datagram(random() % 100);
    for (uint8_t& byte : datagram) byte = random() % 8 == 0 ? 0 : static_cast<uint8_t>(random());
    const Bytes magic = Datagram("LC02");
    if (datagram.size() >= magic.size()) std::copy(magic.begin(), magic.end(), datagram.begin());
    const auto packet = ParseLcmPacket(datagram);
    if (!packet) continue;
    EXPECT_GE(packet->channel.size(), 1U);
    EXPECT_LE(packet->channel.size(), kMaxLcmChannel);
    EXPECT_EQ(packet->channel.find('\0'), std::string_view::npos);
    EXPECT_EQ(kLcmHeaderSize + packet->channel.size() + 1 + packet->payload.size(), datagram.size());
  }
}

}  // namespace
}  // namespace armada
