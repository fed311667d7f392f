// python-can as an independent judge of the datagrams and of the bus, in both directions.
#include <gtest/gtest.h>

#include <random>

#include "firmware/can/udp_bus.h"
#include "firmware/can/udp_frame_codec.h"
#include "firmware/clock/machine_clock.h"
#include "tests/can/frames.h"
#include "tests/can/private_network.h"
#include "tests/can/python_judge.h"
#include "tests/support/hex.h"

namespace armada {
namespace {

constexpr int64_t kForever_ns = INT64_MAX / 2;
constexpr char kGroup[] = "239.74.163.11";
constexpr uint16_t kPort = 43113;

TEST(PythonCan, PacksTheSameBytesAsWe) {
  PythonJudge judge({"codec"});
  std::mt19937_64 random(1);
  for (int i = 0; i < 300; ++i) {
    const CanFrame frame = RandomFrame(&random);
    UdpFrameBuffer buffer;
    const size_t size = EncodeUdpFrame(frame, 1700000000.25, &buffer);
    judge.Ask("pack 1700000000.25 " + Describe(frame));
    ASSERT_EQ(judge.Answer(), Hex({buffer.data(), size})) << Describe(frame);
  }
}

TEST(PythonCan, UnpacksWhatWePack) {
  PythonJudge judge({"codec"});
  std::mt19937_64 random(2);
  for (int i = 0; i < 300; ++i) {
    const CanFrame frame = RandomFrame(&random);
    UdpFrameBuffer buffer;
    const size_t size = EncodeUdpFrame(frame, 1.0, &buffer);
    judge.Ask("unpack " + Hex({buffer.data(), size}));
    ASSERT_EQ(judge.Answer(), Describe(frame));
  }
}

TEST(PythonCan, EveryWidthOrderAndFurtherKeyIsRead) {
  PythonJudge judge({"codec"});
  std::mt19937_64 random(3);
  for (int i = 0; i < 40; ++i) {
    const CanFrame frame = RandomFrame(&random);
    judge.Ask("widths " + Describe(frame));
    const std::string count = judge.Answer();
    ASSERT_FALSE(count.empty());
    ASSERT_GT(std::stoi(count), 50);
    for (int n = std::stoi(count); n > 0; --n) {
      const std::string hex = judge.Answer();
      CanFrame read;
      ASSERT_TRUE(DecodeUdpFrame(FromHex(hex), &read)) << hex;
      ASSERT_EQ(Describe(read), Describe(frame)) << hex;
    }
  }
}

TEST(PythonCan, ReceivesWhatTheBusSends) {
  ASSERT_EQ(EnterPrivateNetwork(MulticastRoute::kYes), "");
  PythonJudge judge({"bus", kGroup, std::to_string(kPort)});
  ASSERT_EQ(judge.Answer(), "ready");
  std::string error;
  const auto bus = UdpCanBus::Open(kGroup, kPort, 0, MachineClock::Get(), &error);
  ASSERT_NE(bus, nullptr) << error;
  std::mt19937_64 random(4);
  for (int i = 0; i < 100; ++i) {
    const CanFrame frame = RandomFrame(&random);
    ASSERT_EQ(bus->Send(frame), BusStatus::kOk);
    judge.Ask("receive");
    ASSERT_EQ(judge.Answer(), Describe(frame));
  }
}

TEST(PythonCan, SendsWhatTheBusReceives) {
  ASSERT_EQ(EnterPrivateNetwork(MulticastRoute::kYes), "");
  std::string error;
  const auto bus = UdpCanBus::Open(kGroup, kPort, 0, MachineClock::Get(), &error);
  ASSERT_NE(bus, nullptr) << error;
  PythonJudge judge({"bus", kGroup, std::to_string(kPort)});
  ASSERT_EQ(judge.Answer(), "ready");
  std::mt19937_64 random(5);
  for (int i = 0; i < 100; ++i) {
    const CanFrame frame = RandomFrame(&random);
    judge.Ask("send " + Describe(frame));
    CanFrame received;
    ASSERT_EQ(bus->Receive(kForever_ns, &received), BusStatus::kOk);
    ASSERT_EQ(Describe(received), Describe(frame));
  }
}

}  // namespace
}  // namespace armada
