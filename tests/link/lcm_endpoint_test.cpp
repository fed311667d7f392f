#include "firmware/link/lcm_endpoint.h"

#include <gtest/gtest.h>
#include <poll.h>

#include <ctime>
#include <random>
#include <vector>

#include "firmware/clock/machine_clock.h"
#include "firmware/link/lcm_packet.h"
#include "tests/link/endpoint_support.h"
#include "tests/link/private_network_fixture.h"
#include "tests/support/limit_malloc.h"
#include "tests/support/numbers.h"

namespace armada {
namespace {

int64_t NowNs() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * 1'000 * kMs + now.tv_nsec;
}

class Endpoint : public PrivateNetworkTest {};

TEST_F(Endpoint, SaysWhatToDoWhenThereIsNoMulticastRoute) {
  WithoutRoutes([] {
    std::string error;
    EXPECT_EQ(LcmEndpoint::Open(LcmUrl(), MachineClock::Get(), &error), nullptr);
    for (const char* part : {"udpm://239.255.76.67:7667?ttl=0", "ip link set lo up multicast on",
                             "ip route add 224.0.0.0/4 dev lo", "armada run"}) {
      EXPECT_NE(error.find(part), std::string::npos) << error;
    }
  });
}

TEST_F(Endpoint, CountsAMessageThatTheKernelRefuses) {
  WithoutRoutes([] {
    std::string error;
    ASSERT_TRUE(EnterPrivateNetwork(&error)) << error;
    const auto endpoint = OpenEndpoint();
    EXPECT_TRUE(endpoint->Publish("A", {}));
    TakeLoopbackDown();
    EXPECT_FALSE(endpoint->Publish("A", {}));
    EXPECT_EQ(endpoint->counters().sent, 1U);
    EXPECT_EQ(endpoint->counters().send_failures, 1U);
  });
}

TEST_F(Endpoint, DeliversToEveryEndpointOfTheHostAndToTheSender) {
  const auto sender = OpenEndpoint();
  const auto receiver = OpenEndpoint();
  const std::vector<uint8_t> payload = {1, 2, 3};
  ASSERT_TRUE(sender->Publish("EST_1", payload));
  for (LcmEndpoint* endpoint : {sender.get(), receiver.get()}) {
    EXPECT_EQ(DrainMessages(endpoint, 1), (std::vector<Message>{{"EST_1", payload}}));
    EXPECT_EQ(endpoint->counters().received, 1U);
  }
}

TEST_F(Endpoint, KeepsTheOrderOfMessages) {
  const auto endpoint = OpenEndpoint();
  std::vector<Message> sent;
  for (uint8_t i = 0; i < 100; ++i) {
    sent.push_back({"A", {i}});
    ASSERT_TRUE(endpoint->Publish("A", sent.back().payload));
  }
  EXPECT_EQ(DrainMessages(endpoint.get(), sent.size()), sent);
}

TEST_F(Endpoint, DrainsNoMoreThanAsked) {
  const auto endpoint = OpenEndpoint();
  for (int i = 0; i < 50; ++i) ASSERT_TRUE(endpoint->Publish("A", {}));
  int handled = 0;
  const auto count = [&handled](const LcmMessage&) { ++handled; };
  WaitForInput(*endpoint);
  EXPECT_EQ(endpoint->Drain(count, 40), 40);
  EXPECT_EQ(endpoint->Drain(count, 40), 10);
  EXPECT_EQ(endpoint->Drain(count, 40), 0);
  EXPECT_EQ(handled, 50);
}

TEST_F(Endpoint, RefusesToPublishWhatItCouldNotReceive) {
  const auto endpoint = OpenEndpoint();
  const std::vector<uint8_t> largest(LcmEndpoint::kMaxDatagram - kLcmHeaderSize - 2, 7);
  const std::vector<uint8_t> larger(largest.size() + 1);
  EXPECT_TRUE(endpoint->Publish("A", largest));
  EXPECT_FALSE(endpoint->Publish("A", larger));
  EXPECT_FALSE(endpoint->Publish("", {}));
  EXPECT_FALSE(endpoint->Publish(std::string(kMaxLcmChannel + 1, 'x'), {}));
  EXPECT_EQ(endpoint->counters().sent, 1U);
  EXPECT_EQ(endpoint->counters().send_failures, 3U);
  EXPECT_EQ(DrainMessages(endpoint.get(), 1), (std::vector<Message>{{"A", largest}}));
}

TEST_F(Endpoint, WhatIsTooLongTakesNoRoomInTheQueueAndIsCounted) {
  constexpr uint64_t kMany = 1000;
  const auto endpoint = OpenEndpoint();
  const RawSender raw;
  std::vector<uint8_t> datagram(LcmEndpoint::kMaxDatagram + 1);
  for (uint64_t i = 0; i < kMany; ++i) {
    WriteLcmPacket(0, {"A", {}}, datagram);
    raw.Send(datagram);
    datagram.resize(datagram.size() == 60'000 ? LcmEndpoint::kMaxDatagram + 1 : 60'000);
  }
  ASSERT_TRUE(endpoint->Publish("B", {}));
  EXPECT_EQ(DrainMessages(endpoint.get(), 1), (std::vector<Message>{{"B", {}}}));
  EXPECT_EQ(endpoint->counters().overflowed, kMany);
}

TEST_F(Endpoint, StampsTheArrivalNotTheReading) {
  const auto endpoint = OpenEndpoint();
  // The first datagrams after the option is set may be stamped when they are read: the kernel arms its clock
  // in the background. So the best of several counts.
  int64_t best_wait_ns = 0;
  for (int round = 0; round < 10; ++round) {
    const int64_t before_ns = NowNs();
    ASSERT_TRUE(endpoint->Publish("A", {}));
    WaitForInput(*endpoint);
    poll(nullptr, 0, 20);
    const int64_t read_ns = NowNs();
    endpoint->Drain([&](const LcmMessage& message) {
      EXPECT_GE(message.arrival_ns, before_ns - kMs);
      EXPECT_LE(message.arrival_ns, NowNs());
      best_wait_ns = std::max(best_wait_ns, read_ns - message.arrival_ns);
    });
  }
  EXPECT_GE(best_wait_ns, 19 * kMs);
}

// Junk of every kind: random bytes, right magic with random bytes, fragments, no NUL, empty datagrams.
std::vector<uint8_t> Junk(std::mt19937_64* random) {
  std::vector<uint8_t> datagram((*random)() % 200);
  for (uint8_t& byte : datagram) byte = static_cast<uint8_t>(1 + (*random)() % 255);
  constexpr const char* kMagics[] = {"LC02", "LC03"};
  const auto kind = (*random)() % 3;
  if (kind < 2 && datagram.size() >= 4) std::copy_n(kMagics[kind], 4, datagram.begin());
  return datagram;
}

TEST_F(Endpoint, DeliversEveryMessageThroughAStormOfJunkWithoutAllocating) {
  constexpr int kTicks = 100;
  constexpr int kJunkPerTick = 100;  // 10,000 a second
  constexpr int kMessagesPerTick = 15;
  const auto endpoint = OpenEndpoint();
  const RawSender raw;
  std::mt19937_64 random(1);
  int delivered = 0;
  const auto count = [&delivered](const LcmMessage& message) {
    delivered += message.channel == "EST_1" ? 1 : 0;
  };
  for (int tick = 0; tick < kTicks; ++tick) {
    for (int i = 0; i < kJunkPerTick; ++i) {
      if (i < kMessagesPerTick) {
        ASSERT_TRUE(endpoint->Publish("EST_1", {}));
      }
      raw.Send(Junk(&random));
    }
    const LimitMalloc guard;
    endpoint->Drain(count);
  }
  const LcmCounters& counters = endpoint->counters();
  while (counters.received + counters.malformed < uint64_t{kTicks} * (kJunkPerTick + kMessagesPerTick)) {
    WaitForInput(*endpoint);  // the kernel may have been late with the last tick's
    ASSERT_GT(endpoint->Drain(count), 0);
  }
  EXPECT_EQ(delivered, kTicks * kMessagesPerTick);
  EXPECT_EQ(counters.malformed, uint64_t{kTicks} * kJunkPerTick);
  EXPECT_EQ(counters.overflowed, 0U);
}

TEST_F(Endpoint, TakesUnknownChannelsWithoutAllocating) {
  const auto endpoint = OpenEndpoint();
  const RawSender raw;
  int handled = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::string channel = "A_CHANNEL_NAME_NEVER_HEARD_BEFORE_" + std::to_string(i);
    const LimitMalloc guard;
    ASSERT_TRUE(endpoint->Publish(channel, {}));
    WaitForInput(*endpoint);
    endpoint->Drain([&](const LcmMessage&) { ++handled; });
  }
  EXPECT_EQ(handled, 1000);
}

TEST_F(Endpoint, EmptiesAFullQueueInOneDrainAndCountsWhatTheKernelDropped) {
  constexpr int kFlood = 900;
  const auto endpoint = OpenEndpoint();
  const RawSender raw;
  for (int i = 0; i < kFlood; ++i) raw.Send({});
  WaitForInput(*endpoint);
  const int taken = endpoint->Drain([](const LcmMessage&) {});
  EXPECT_GT(taken, 0);
  EXPECT_LT(taken, LcmEndpoint::kMaxPerDrain) << "it stopped at its limit, not because the queue was empty";

  ASSERT_TRUE(endpoint->Publish("A", {}));
  EXPECT_EQ(DrainMessages(endpoint.get(), 1), (std::vector<Message>{{"A", {}}}));
  EXPECT_GT(endpoint->counters().overflowed, 0U);
  EXPECT_EQ(endpoint->counters().malformed + endpoint->counters().overflowed, uint64_t{kFlood});
}

}  // namespace
}  // namespace armada
