#include "firmware/can/signal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace armada {
namespace {

using Kind = CanSignal::Kind;
using Order = CanSignal::ByteOrder;

CanFrame Frame(std::initializer_list<uint8_t> bytes) {
  CanFrame frame;
  std::copy(bytes.begin(), bytes.end(), frame.data.begin());
  frame.length = 8;
  return frame;
}

TEST(CanSignal, LittleEndianFieldsCountFromTheirLowestBit) {
  const CanFrame frame = Frame({0x34, 0x12, 0xF0});
  EXPECT_EQ(GetRaw(frame, {"whole", 0, 16}), 0x1234u);
  EXPECT_EQ(GetRaw(frame, {"across", 4, 12}), 0x123u);
  EXPECT_EQ(GetRaw(frame, {"flag", 20, 1}), 1u);
}

TEST(CanSignal, BigEndianFieldsCountFromTheirHighestBit) {
  const CanFrame frame = Frame({0x12, 0x34, 0x56});
  EXPECT_EQ(GetRaw(frame, {"whole", 7, 16, Kind::kUnsigned, Order::kBig}), 0x1234u);
  EXPECT_EQ(GetRaw(frame, {"across", 3, 12, Kind::kUnsigned, Order::kBig}), 0x234u);
  EXPECT_EQ(GetRaw(frame, {"rest", 19, 4, Kind::kUnsigned, Order::kBig}), 0x6u);
}

TEST(CanSignal, ScaledFieldsRoundAndClip) {
  const CanSignal signal{"x", 0, 12, Kind::kUnsigned, Order::kLittle, "rad", 0.1, -100.0};
  CanFrame frame;
  PutPhysical(signal, 3.14, &frame);
  EXPECT_NEAR(GetPhysical(frame, signal), 3.1, 1e-12);
  PutPhysical(signal, 1e9, &frame);
  EXPECT_EQ(GetRaw(frame, signal), 0xFFFu);
  PutPhysical(signal, -1e9, &frame);
  EXPECT_EQ(GetRaw(frame, signal), 0u);
  PutPhysical(signal, NAN, &frame);
  EXPECT_NEAR(GetPhysical(frame, signal), 0.0, 1e-12);
}

TEST(CanSignal, SignedFieldsHaveTwosComplement) {
  const CanSignal signal{"x", 0, 16, Kind::kSigned};
  CanFrame frame;
  for (const double value : {-32768.0, -1.0, 0.0, 1.0, 32767.0}) {
    PutPhysical(signal, value, &frame);
    EXPECT_EQ(GetPhysical(frame, signal), value);
  }
  PutPhysical(signal, -1.0, &frame);
  EXPECT_EQ(frame.data[0], 0xFF);
  EXPECT_EQ(frame.data[1], 0xFF);
}

TEST(CanSignal, WhatIsPutComesOutAndNothingElseChanges) {
  std::mt19937 random(1);
  for (int i = 0; i < 20'000; ++i) {
    const auto bits = static_cast<uint8_t>(1 + random() % 32);
    const bool big = (random() & 1) != 0;
    // Any place in which the field lies within eight bytes.
    const auto first = static_cast<uint16_t>(random() % (64u - bits + 1u));
    const auto start = big ? static_cast<uint16_t>(first / 8 * 8 + (7 - first % 8)) : first;
    const CanSignal signal{"x", start, bits, Kind::kUnsigned, big ? Order::kBig : Order::kLittle};
    CanFrame before;
    for (uint8_t& byte : before.data) byte = static_cast<uint8_t>(random());
    const auto raw = static_cast<uint32_t>(random() & ((uint64_t{1} << bits) - 1));
    CanFrame after = before;
    PutRaw(signal, raw, &after);
    ASSERT_EQ(GetRaw(after, signal), raw);
    PutRaw(signal, GetRaw(before, signal), &after);
    ASSERT_EQ(after.data, before.data);
  }
}

}  // namespace
}  // namespace armada
