#include "firmware/can/udp_frame_codec.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "tests/can/frames.h"

namespace armada {
namespace {

struct Golden {
  double timestamp_s;
  const char* frame;  // as Describe() writes it
  const char* hex;    // made by python-can 4.1.0, msgpack 1.0.3: pack_message()
};

constexpr Golden kGolden[] = {
    {1700000000.25, "41 0 0 0 0 0 0 8 0000803f000020c0",
     "8ba974696d657374616d70cb41d954fc40100000ae6172626974726174696f6e5f696429ae69735f657874656e6465645f6964c"
     "2"
     "af69735f72656d6f74655f6672616d65c2ae69735f6572726f725f6672616d65c2a76368616e6e656cc0a3646c6308a46461746"
     "1"
     "c4080000803f000020c0a569735f6664c2ae626974726174655f737769746368c2b56572726f725f73746174655f696e6469636"
     "1"
     "746f72c2"},
    {0.0, "448585456 1 0 0 1 1 1 12 000102030405060708090a0b",
     "8ba974696d657374616d70cb0000000000000000ae6172626974726174696f6e5f6964ce1abcdef0ae69735f657874656e64656"
     "4"
     "5f6964c3af69735f72656d6f74655f6672616d65c2ae69735f6572726f725f6672616d65c2a76368616e6e656cc0a3646c630ca"
     "4"
     "64617461c40c000102030405060708090a0ba569735f6664c3ae626974726174655f737769746368c3b56572726f725f7374617"
     "4"
     "655f696e64696361746f72c3"},
    {2.5, "2025 0 1 0 0 0 0 8 -",
     "8ba974696d657374616d70cb4004000000000000ae6172626974726174696f6e5f6964cd07e9ae69735f657874656e6465645f6"
     "9"
     "64c2af69735f72656d6f74655f6672616d65c3ae69735f6572726f725f6672616d65c2a76368616e6e656cc0a3646c6308a4646"
     "1"
     "7461c400a569735f6664c2ae626974726174655f737769746368c2b56572726f725f73746174655f696e64696361746f72c2"},
};

std::vector<uint8_t> Encode(const CanFrame& frame) {
  UdpFrameBuffer buffer;
  const size_t size = EncodeUdpFrame(frame, 1.0, &buffer);
  return {buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(size)};
}

/// The datagram with the first occurrence of `from` replaced.
std::vector<uint8_t> Replace(const std::vector<uint8_t>& datagram, const std::string& from,
                             const std::string& to) {
  std::string text(datagram.begin(), datagram.end());
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  if (at != std::string::npos) text.replace(at, from.size(), to);
  return {text.begin(), text.end()};
}

bool Reads(const std::vector<uint8_t>& datagram) {
  CanFrame frame;
  return DecodeUdpFrame(datagram, &frame);
}

TEST(UdpFrameCodec, ReadsAndWritesPythonCansBytes) {
  for (const Golden& golden : kGolden) {
    const std::vector<uint8_t> bytes = FromHex(golden.hex);
    CanFrame frame;
    ASSERT_TRUE(DecodeUdpFrame(bytes, &frame)) << golden.frame;
    EXPECT_EQ(Describe(frame), golden.frame);
    UdpFrameBuffer buffer;
    const size_t size = EncodeUdpFrame(frame, golden.timestamp_s, &buffer);
    EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), buffer.begin(), buffer.begin() + size))
        << golden.frame;
  }
}

TEST(UdpFrameCodec, WhatIsWrittenIsReadBack) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 20000; ++i) {
    const CanFrame frame = RandomFrame(&random);
    CanFrame read;
    ASSERT_TRUE(DecodeUdpFrame(Encode(frame), &read)) << Describe(frame);
    ASSERT_EQ(Describe(read), Describe(frame));
    ASSERT_EQ(read.stamp_ns, 0);
  }
}

TEST(UdpFrameCodec, FramesNoBusCanCarryAreNotWritten) {
  const CanFrame good = DataFrame(0x29, {1, 2, 3});
  ASSERT_FALSE(Encode(good).empty());
  const auto refused = [&](auto change) {
    CanFrame frame = good;
    change(frame);
    return Encode(frame).empty();
  };
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.id = 0x800; }));
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.id = 0x2000'0000, frame.extended = true; }));
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.length = 9; }));
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.length = 9, frame.fd = true; }));
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.length = 65, frame.fd = true; }));
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.remote = frame.fd = true; }));
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.remote = frame.error = true; }));
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.bitrate_switch = true; }));
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.error_state_indicator = true; }));
}

TEST(UdpFrameCodec, EveryCutAndEveryFurtherByteIsRefused) {
  std::vector<uint8_t> datagram = Encode(DataFrame(0x7E9, {1, 2, 3, 4, 5, 6, 7, 8}));
  ASSERT_TRUE(Reads(datagram));
  for (size_t size = 0; size < datagram.size(); ++size) {
    EXPECT_FALSE(Reads({datagram.begin(), datagram.begin() + static_cast<std::ptrdiff_t>(size)})) << size;
  }
  datagram.push_back(0xC0);
  EXPECT_FALSE(Reads(datagram));
}

TEST(UdpFrameCodec, ARefusedDatagramLeavesTheFrameAlone) {
  std::vector<uint8_t> datagram = Encode(DataFrame(0x7E9, {1, 2, 3}));
  datagram.pop_back();
  CanFrame frame = DataFrame(0x123, {9});
  EXPECT_FALSE(DecodeUdpFrame(datagram, &frame));
  EXPECT_EQ(Describe(frame), Describe(DataFrame(0x123, {9})));
}

TEST(UdpFrameCodec, WrongKeysAreRefused) {
  const std::vector<uint8_t> datagram = Encode(DataFrame(0x29, {1, 2, 3}));
  EXPECT_FALSE(Reads(Replace(datagram, "is_error_frame", "is_error_fra_e"))) << "a key is missing";
  std::vector<uint8_t> twelve = datagram;
  twelve[0] = 0x8C;
  const std::string extra = "\xA5other\xC2";
  const std::string twice = "\xA5is_fd\xC2";
  twelve.insert(twelve.end(), extra.begin(), extra.end());
  EXPECT_TRUE(Reads(twelve)) << "one key more";
  EXPECT_FALSE(Reads(Replace(twelve, extra, twice))) << "a key comes twice";
  EXPECT_FALSE(Reads(Replace(datagram,
                             "\xA3"
                             "dlc",
                             "\xC4\x03"
                             "dlc")))
      << "a key is not a string";
  EXPECT_TRUE(Reads(Replace(datagram, "channel", "chamber")))
      << "unknown keys are skipped, the channel not needed";
  EXPECT_TRUE(Reads(Replace(datagram, "timestamp", "tombstone")));
}

TEST(UdpFrameCodec, WrongValuesAreRefused) {
  const std::vector<uint8_t> datagram = Encode(DataFrame(0x29, {1, 2, 3}));
  const std::string is_fd = "\xA5is_fd";
  EXPECT_FALSE(Reads(Replace(datagram, is_fd + '\xC2', is_fd + '\xC0'))) << "nil is no flag";
  EXPECT_FALSE(Reads(Replace(datagram, is_fd + '\xC2', is_fd + '\x02'))) << "2 is no flag";
  EXPECT_TRUE(Reads(Replace(datagram, is_fd + '\xC2', is_fd + '\x01')));
  EXPECT_FALSE(Reads(Replace(datagram, "dlc\x03", "dlc\x04"))) << "dlc does not match the data";
  EXPECT_FALSE(Reads(Replace(datagram, "dlc\x03", "dlc\xD0\xFD"))) << "negative";
  EXPECT_FALSE(Reads(Replace(datagram, "dlc\x03", "dlc\xA1\x33"))) << "text";
  EXPECT_FALSE(Reads(Replace(datagram, "arbitration_id\x29", "arbitration_id\xCD\x08\x29")))
      << "more than 11 bits";
  EXPECT_FALSE(
      Reads(Replace(datagram, "arbitration_id\x29", std::string("arbitration_id\xCF\0\0\0\1\0\0\0\x29", 23))))
      << "more than 32 bits must not wrap round";
  EXPECT_FALSE(Reads(Replace(datagram, "data\xC4\x03", "data\xA3"))) << "data as text";
  EXPECT_FALSE(Reads(Replace(datagram, "data\xC4\x03", std::string("data\xC6\xFF\xFF\xFF\xFF", 9))))
      << "a size of 4 GiB in a datagram";
}

TEST(UdpFrameCodec, HostileNestingEnds) {
  for (const char* hostile :
       {"\x91", "\xDC\xFF\xFF", "\xDD\xFF\xFF\xFF\xFF", "\xDF\xFF\xFF\xFF\xFF", "\x8F"}) {
    std::vector<uint8_t> bytes = FromHex("81a161");
    for (int depth = 0; depth < 2000; ++depth)
      bytes.insert(bytes.end(), hostile, hostile + std::strlen(hostile));
    EXPECT_FALSE(Reads(bytes));
  }
}

// Seeded fuzzing: whatever comes in, decoding ends without touching foreign memory (the sanitizers watch),
// and what is accepted is a frame that a bus can carry and that survives a round trip.
TEST(UdpFrameCodec, DamagedDatagramsNeverYieldAnImpossibleFrame) {
  std::mt19937_64 random(7);
  int accepted = 0;
  for (int i = 0; i < 200000; ++i) {
    std::vector<uint8_t> datagram = Encode(RandomFrame(&random));
    for (uint64_t damages = 1 + random() % 4; damages > 0 && !datagram.empty(); --damages) {
      const size_t at = random() % datagram.size();
      switch (random() % 4) {
        case 0:
          datagram[at] = static_cast<uint8_t>(random());
          break;
        case 1:
          datagram[at] ^= static_cast<uint8_t>(1u << random() % 8);
          break;
        case 2:
          datagram.erase(datagram.begin() + static_cast<std::ptrdiff_t>(at));
          break;
        default:
          datagram.insert(datagram.begin() + static_cast<std::ptrdiff_t>(at), static_cast<uint8_t>(random()));
      }
    }
    CanFrame frame;
    if (!DecodeUdpFrame(datagram, &frame)) continue;
    ++accepted;
    ASSERT_TRUE(IsValid(frame));
    CanFrame again;
    ASSERT_TRUE(DecodeUdpFrame(Encode(frame), &again));
    ASSERT_EQ(Describe(again), Describe(frame));
  }
  EXPECT_GT(accepted, 1000) << "damage to payload bytes alone still gives frames";
}

TEST(UdpFrameCodec, NoiseIsRefused) {
  std::mt19937_64 random(8);
  for (int i = 0; i < 100000; ++i) {
    std::vector<uint8_t> datagram(random() % 200);
    for (uint8_t& byte : datagram) byte = static_cast<uint8_t>(random());
    ASSERT_FALSE(Reads(datagram));
  }
}

}  // namespace
}  // namespace armada
