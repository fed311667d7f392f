#include "firmware/can/frame_time.h"

#include <gtest/gtest.h>

namespace armada {
namespace {

TEST(FrameTime, FramesAreAsLongAsStuffingMakesThem) {
  const CanBusConfig bus;
  CanFrame frame;
  const auto bits = [&](uint8_t length) {
    frame.length = length;
    return WorstFrameTime_s(frame, bus) * 1e6;
  };
  EXPECT_DOUBLE_EQ(bits(8), 135.0);
  EXPECT_DOUBLE_EQ(bits(4), 95.0);
  EXPECT_DOUBLE_EQ(bits(0), 55.0);
  frame.remote = true;
  EXPECT_DOUBLE_EQ(bits(8), 55.0) << "a remote frame carries no data";
  frame.remote = false;
  frame.extended = true;
  EXPECT_DOUBLE_EQ(bits(8), 160.0);
}

TEST(FrameTime, GoesWithTheBitRate) {
  CanBusConfig slow;
  slow.bitrate_bit_s = 250e3;
  CanFrame frame;
  frame.length = 8;
  EXPECT_DOUBLE_EQ(WorstFrameTime_s(frame, slow), 135.0 / 250e3);
}

TEST(FrameTime, OnlyTheDataOfAFastFrameGoesAtTheDataRate) {
  CanBusConfig bus;
  CanFrame frame;
  frame.fd = true;
  frame.length = 64;
  const double slow_s = WorstFrameTime_s(frame, bus);
  frame.bitrate_switch = true;
  const double fast_s = WorstFrameTime_s(frame, bus);
  // 17 bits of arbitration with at most 4 stuff bits, and 13 from the CRC delimiter on, stay at 1 Mbit/s.
  const double arbitration_s = 34e-6;
  EXPECT_NEAR(fast_s, arbitration_s + (slow_s - arbitration_s) / 5.0, 1e-9);
  EXPECT_LT(fast_s, 180e-6);
}

}  // namespace
}  // namespace armada
