// The SocketCAN backend on the kernel's virtual CAN.

#include "firmware/can/socketcan_bus.h"

#include <gtest/gtest.h>

#include <random>

#include "firmware/can/can_link.h"
#include "firmware/clock/monotonic.h"
#include "tests/can/frames.h"
#include "tests/support/limit_malloc.h"
#include "tests/support/numbers.h"
#include "tests/vcan/vcan_interface.h"

namespace armada {
namespace {

constexpr int64_t kPoll = 0;  // a deadline long past

int64_t In(int64_t duration_ns) {
  return Now_ns(CLOCK_MONOTONIC) + duration_ns;
}

CanFrame Torque(uint32_t id, uint8_t value) {
  CanFrame frame = DataFrame(id, {value});
  frame.latest_only = true;
  return frame;
}

class SocketCan : public testing::Test {
 protected:
  std::unique_ptr<SocketCanBus> Open(const BusOptions& options = {}) {
    std::string error;
    auto bus = SocketCanBus::Open(interface_.name(), options, &error);
    EXPECT_NE(bus, nullptr) << error;
    return bus;
  }
  std::string OpenError(const BusOptions& options) {
    std::string error;
    EXPECT_EQ(SocketCanBus::Open(interface_.name(), options, &error), nullptr);
    return error;
  }

  VcanInterface interface_{"vcan0"};
};

TEST_F(SocketCan, FramesOfEveryKindArriveAsTheyWereSent) {
  BusOptions options;
  options.fd = true;
  const auto sender = Open(options);
  const auto receiver = Open(options);
  std::mt19937_64 random(1);
  CanFrame received;
  for (int i = 0; i < 2000; ++i) {
    CanFrame frame = RandomFrame(&random);
    if (frame.error) continue;
    if (frame.fd) frame.remote = false;
    const int64_t before_ns = In(0);
    ASSERT_EQ(sender->Send(frame), BusStatus::kOk) << Describe(frame);
    ASSERT_EQ(receiver->Receive(In(1000 * kMs), &received), BusStatus::kOk);
    EXPECT_EQ(Describe(received), Describe(frame));
    EXPECT_GE(received.stamp_ns, before_ns - kMs / 100) << "two clocks were read one after the other";
    EXPECT_LE(received.stamp_ns, In(0));
    ASSERT_EQ(sender->Flush(In(1000 * kMs)), BusStatus::kOk);
    ASSERT_EQ(sender->Receive(kPoll, &received), BusStatus::kTimeout) << "own frames are not handed over";
  }
  EXPECT_EQ(sender->counters().sent, receiver->counters().received);
}

TEST_F(SocketCan, AClassicBusNeitherSendsNorHearsFd) {
  const auto classic = Open();
  BusOptions options;
  options.fd = true;
  const auto fd = Open(options);
  CanFrame frame = DataFrame(1, {1});
  frame.fd = true;
  EXPECT_EQ(classic->Send(frame), BusStatus::kQueueFull);
  EXPECT_EQ(classic->counters().malformed, 1u);
  ASSERT_EQ(fd->Send(frame), BusStatus::kOk);
  CanFrame received;
  EXPECT_EQ(classic->Receive(In(20 * kMs), &received), BusStatus::kTimeout);
}

TEST_F(SocketCan, TheKernelFilters) {
  BusOptions options;
  options.filters = {{.id = 0x60, .mask = 0x7E0}, {.id = 0x12345, .mask = 0x1FFFFFFF, .extended = true}};
  const auto bus = Open(options);
  const auto other = Open();
  CanFrame wide = DataFrame(0x12345, {2});
  wide.extended = true;
  CanFrame wide_of_another = DataFrame(0x65, {3});
  wide_of_another.extended = true;
  for (const CanFrame& frame : {DataFrame(0x7F, {1}), DataFrame(0x80, {9}), wide, wide_of_another}) {
    ASSERT_EQ(other->Send(frame), BusStatus::kOk);
  }
  CanFrame received;
  ASSERT_EQ(bus->Receive(In(1000 * kMs), &received), BusStatus::kOk);
  EXPECT_EQ(received.id, 0x7Fu);
  ASSERT_EQ(bus->Receive(In(1000 * kMs), &received), BusStatus::kOk);
  EXPECT_EQ(received.id, 0x12345u);
  EXPECT_EQ(bus->Receive(In(20 * kMs), &received), BusStatus::kTimeout);
}

TEST_F(SocketCan, ReceiveKeepsItsDeadlineToTheMillisecond) {
  const auto bus = Open();
  CanFrame frame;
  const int64_t begin_ns = In(0);
  EXPECT_EQ(bus->Receive(begin_ns + 3'700'000, &frame), BusStatus::kTimeout);
  const int64_t took_ns = In(0) - begin_ns;
  EXPECT_GE(took_ns, 3'700'000);
  EXPECT_LT(took_ns, 4'700'000) << "in virtual time; SO_RCVTIMEO would round up to jiffies of 4 ms";
}

TEST_F(SocketCan, ChangesOfTheControllersStateAreValues) {
  const auto bus = Open();
  CanFrame frame;
  const auto hear = [&](const char* error_frame) {
    interface_.InjectError(error_frame);
    return bus->Receive(In(1000 * kMs), &frame);
  };
  EXPECT_EQ(hear(kTxPassive), BusStatus::kErrorPassive);
  EXPECT_EQ(hear(kTxWarning), BusStatus::kErrorActive);
  EXPECT_EQ(hear(kBusOff), BusStatus::kBusOff);
  EXPECT_EQ(hear(kRestarted), BusStatus::kRestarted);
  EXPECT_EQ(hear(kLostArbitration), BusStatus::kOk);
  EXPECT_TRUE(frame.error);
  const BusCounters& counters = bus->counters();
  EXPECT_EQ(counters.errors, 5u);
  EXPECT_EQ(counters.error_passive, 1u);
  EXPECT_EQ(counters.bus_off, 1u);
  EXPECT_EQ(counters.restarts, 1u);
  EXPECT_EQ(counters.received, 0u);
}

TEST_F(SocketCan, ALinkThatGoesDownIsDownForGoodAndNothingOldIsSent) {
  const auto bus = Open();
  const auto witness_before = Open();
  CanFrame frame;
  interface_.SetDown();
  EXPECT_EQ(bus->Receive(In(1000 * kMs), &frame), BusStatus::kDown);
  EXPECT_EQ(bus->Send(Torque(1, 1)), BusStatus::kDown);
  EXPECT_EQ(bus->Flush(kPoll), BusStatus::kDown);
  interface_.SetUp();
  const auto witness = Open();
  EXPECT_EQ(bus->Send(Torque(1, 2)), BusStatus::kDown) << "until it is opened anew";
  EXPECT_EQ(bus->Receive(kPoll, &frame), BusStatus::kDown);
  EXPECT_EQ(witness->Receive(In(50 * kMs), &frame), BusStatus::kTimeout);
}

TEST_F(SocketCan, TheFirstSendOnALinkThatWentDownSaysSo) {
  const auto bus = Open();
  interface_.SetDown();
  EXPECT_EQ(bus->Send(Torque(1, 1)), BusStatus::kDown);
}

TEST_F(SocketCan, OnABusyBusOnlyTheNewestTorqueOfEachDriveIsSent) {
  BusOptions options;
  options.config.transmit_window = 1;
  const auto bus = Open(options);
  const auto drive = Open();
  interface_.Delay(5, 100);
  ASSERT_EQ(bus->Send(DataFrame(0x10, {0})), BusStatus::kOk);  // takes 5 ms
  for (uint8_t value = 1; value <= 9; ++value) {
    ASSERT_EQ(bus->Send(Torque(0x11, value)), BusStatus::kOk);
    ASSERT_EQ(bus->Send(Torque(0x12, value)), BusStatus::kOk);
  }
  EXPECT_EQ(bus->Flush(In(100 * kMs)), BusStatus::kOk);
  CanFrame frame;
  for (const uint32_t id : {0x10u, 0x11u, 0x12u}) {
    ASSERT_EQ(drive->Receive(kPoll, &frame), BusStatus::kOk);
    EXPECT_EQ(frame.id, id);
    EXPECT_EQ(frame.data[0], id == 0x10 ? 0 : 9);
  }
  EXPECT_EQ(drive->Receive(kPoll, &frame), BusStatus::kTimeout);
  EXPECT_EQ(bus->counters().replaced, 16u);
  EXPECT_EQ(bus->counters().sent, 3u);
}

TEST_F(SocketCan, WhatIsNotOnTheWireInTimeIsDroppedNotSentLate) {
  BusOptions options;
  options.config.transmit_window = 1;
  const auto bus = Open(options);
  const auto drive = Open();
  interface_.Delay(50, 100);
  for (uint32_t id = 1; id <= 4; ++id) ASSERT_EQ(bus->Send(Torque(id, 1)), BusStatus::kOk);
  EXPECT_EQ(bus->Flush(In(2 * kMs)), BusStatus::kTimeout);
  EXPECT_EQ(bus->counters().dropped_late, 3u);
  CanFrame frame;
  ASSERT_EQ(drive->Receive(In(100 * kMs), &frame), BusStatus::kOk);
  EXPECT_EQ(frame.id, 1u) << "was with the kernel, which cannot be called back";
  EXPECT_EQ(drive->Receive(In(200 * kMs), &frame), BusStatus::kTimeout);
}

TEST_F(SocketCan, AFullQueueOfTheKernelIsCountedAndSaid) {
  BusOptions options;
  options.config.transmit_window = 8;
  const auto bus = Open(options);
  const auto drive = Open();
  interface_.Delay(10, 3);
  BusStatus worst = BusStatus::kOk;
  for (uint32_t id = 1; id <= 8; ++id) {
    const BusStatus status = bus->Send(Torque(id, 1));
    if (status != BusStatus::kOk) worst = status;
  }
  EXPECT_EQ(worst, BusStatus::kQueueFull);
  EXPECT_EQ(bus->counters().dropped_queue_full, 5u);
  EXPECT_EQ(bus->Flush(In(100 * kMs)), BusStatus::kQueueFull) << "said once more to who waits for proof";
  EXPECT_EQ(bus->Flush(In(100 * kMs)), BusStatus::kOk);
  CanFrame frame;
  for (uint32_t id = 1; id <= 3; ++id) {
    ASSERT_EQ(drive->Receive(kPoll, &frame), BusStatus::kOk);
    EXPECT_EQ(frame.id, id);
  }
  EXPECT_EQ(drive->Receive(In(50 * kMs), &frame), BusStatus::kTimeout);
}

TEST_F(SocketCan, ABusOffForgetsWhatWaited) {
  BusOptions options;
  options.config.transmit_window = 1;
  const auto bus = Open(options);
  const auto drive = Open();
  interface_.Delay(20, 100);
  ASSERT_EQ(bus->Send(Torque(1, 1)), BusStatus::kOk);
  ASSERT_EQ(bus->Send(Torque(2, 1)), BusStatus::kOk);
  interface_.InjectError(kBusOff);  // passes the same queue, behind the first torque
  CanFrame frame;
  BusStatus status = BusStatus::kTimeout;
  for (int i = 0; i < 10 && status != BusStatus::kBusOff; ++i) status = bus->Receive(In(100 * kMs), &frame);
  EXPECT_EQ(status, BusStatus::kBusOff);
  EXPECT_EQ(bus->Flush(kPoll), BusStatus::kOk) << "nothing waits";
}

TEST_F(SocketCan, FramesThatComeWhileAFlushWaitsAreNotLost) {
  const auto bus = Open();
  const auto drive = Open();
  for (uint32_t id = 1; id <= 20; ++id) ASSERT_EQ(drive->Send(DataFrame(0x100 + id, {1})), BusStatus::kOk);
  ASSERT_EQ(drive->Flush(In(100 * kMs)), BusStatus::kOk);
  ASSERT_EQ(bus->Send(Torque(1, 1)), BusStatus::kOk);
  ASSERT_EQ(bus->Flush(In(100 * kMs)), BusStatus::kOk);
  CanFrame frame;
  for (uint32_t id = 1; id <= 20; ++id) {
    ASSERT_EQ(bus->Receive(kPoll, &frame), BusStatus::kOk);
    EXPECT_EQ(frame.id, 0x100 + id);
  }
}

TEST_F(SocketCan, WhatDoesNotFitIsSaidWithTheCommandThatMendsIt) {
  Shell("ip link set vcan0 down && ip link set vcan0 mtu 16 up");
  BusOptions fd;
  fd.fd = true;
  EXPECT_NE(OpenError(fd).find("sudo ip link set vcan0 mtu 72"), std::string::npos) << OpenError(fd);
  interface_.SetDown();
  EXPECT_NE(OpenError({}).find("sudo ip link set vcan0 up"), std::string::npos) << OpenError({});
  std::string error;
  EXPECT_EQ(SocketCanBus::Open("lo", {}, &error), nullptr);
  EXPECT_NE(error.find("no CAN interface"), std::string::npos) << error;
}

TEST_F(SocketCan, NothingAllocates) {
  const auto bus = Open();
  const auto other = Open();
  CanFrame frame;
  const LimitMalloc guard;
  for (uint8_t i = 0; i < 100; ++i) {
    ASSERT_EQ(bus->Send(Torque(1, i)), BusStatus::kOk);
    ASSERT_EQ(bus->Flush(In(100 * kMs)), BusStatus::kOk);
    ASSERT_EQ(other->Receive(In(100 * kMs), &frame), BusStatus::kOk);
    ASSERT_EQ(bus->Receive(kPoll, &frame), BusStatus::kTimeout);
  }
}

}  // namespace
}  // namespace armada
