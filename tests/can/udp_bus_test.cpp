#include "firmware/can/udp_bus.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <ctime>
#include <random>

#include "firmware/can/open_bus.h"
#include "firmware/can/udp_frame_codec.h"
#include "firmware/clock/machine_clock.h"
#include "tests/can/frames.h"
#include "tests/can/private_network.h"
#include "tests/support/limit_malloc.h"

namespace armada {
namespace {

constexpr int64_t kPoll = 0;  // a deadline long past
constexpr int64_t kForever_ns = INT64_MAX / 2;
constexpr uint16_t kPort = 43113;
constexpr char kGroup[] = "239.74.163.11";

int64_t Now_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * 1'000'000'000 + now.tv_nsec;
}

/// Sends bytes that no bus made to a group.
class Stranger {
 public:
  Stranger() : socket_(socket(AF_INET, SOCK_DGRAM, 0)) {}

  void Send(std::span<const uint8_t> bytes) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(kPort);
    inet_pton(AF_INET, kGroup, &to.sin_addr);
    ASSERT_EQ(
        sendto(socket_.get(), bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&to), sizeof to),
        static_cast<ssize_t>(bytes.size()));
  }

 private:
  UniqueFd socket_;
};

class UdpBus : public testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(EnterPrivateNetwork(MulticastRoute::kYes), ""); }

  static std::unique_ptr<UdpCanBus> Open(const char* group = kGroup) {
    std::string error;
    auto bus = UdpCanBus::Open(group, kPort, 0, MachineClock::Get(), &error);
    EXPECT_NE(bus, nullptr) << error;
    return bus;
  }
};

TEST_F(UdpBus, EveryOtherMemberReceivesAFrameOnceAndTheSenderDoesNot) {
  const auto sender = Open();
  const auto arm = Open();
  const auto viewer = Open();
  const CanFrame sent = DataFrame(0x29, {1, 2, 3});
  ASSERT_EQ(sender->Send(sent), BusStatus::kOk);
  for (const auto& bus : {arm.get(), viewer.get()}) {
    CanFrame received;
    ASSERT_EQ(bus->Receive(kForever_ns, &received), BusStatus::kOk);
    EXPECT_EQ(Describe(received), Describe(sent));
    EXPECT_EQ(bus->Receive(kPoll, &received), BusStatus::kTimeout);
    EXPECT_EQ(bus->counters().received, 1u);
  }
  CanFrame received;
  EXPECT_EQ(sender->Receive(kPoll, &received), BusStatus::kTimeout);
  EXPECT_EQ(sender->counters().sent, 1u);
  EXPECT_EQ(sender->counters().received, 0u);
  EXPECT_EQ(sender->counters().malformed, 0u);
}

TEST_F(UdpBus, AnotherProcessOnTheHostReceivesAFrame) {
  const auto bus = Open();
  const CanFrame question = DataFrame(0x100, {42});
  const pid_t child = fork();
  if (child == 0) {
    const auto other = Open();
    if (other->Send(question) != BusStatus::kOk) _exit(2);
    CanFrame answer;
    const bool answered = other->Receive(kForever_ns, &answer) == BusStatus::kOk && answer.id == 0x101;
    _exit(answered ? 0 : 1);
  }
  CanFrame received;
  ASSERT_EQ(bus->Receive(kForever_ns, &received), BusStatus::kOk);
  EXPECT_EQ(Describe(received), Describe(question));
  ASSERT_EQ(bus->Send(DataFrame(0x101, {})), BusStatus::kOk);
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

TEST_F(UdpBus, OtherGroupsOnTheSamePortAreNotHeard) {
  const auto arm_1 = Open("239.74.163.11");
  const auto arm_2 = Open("239.74.163.12");
  const auto plant_2 = Open("239.74.163.12");
  ASSERT_EQ(plant_2->Send(DataFrame(0x29, {2})), BusStatus::kOk);
  CanFrame received;
  ASSERT_EQ(arm_2->Receive(kForever_ns, &received), BusStatus::kOk);
  EXPECT_EQ(arm_1->Receive(kPoll, &received), BusStatus::kTimeout);
}

TEST_F(UdpBus, FramesOfAllKindsComeInOrder) {
  const auto sender = Open();
  const auto receiver = Open();
  std::mt19937_64 random(1);
  for (int batch = 0; batch < 20; ++batch) {
    std::array<CanFrame, 50> frames;
    for (CanFrame& frame : frames) {
      frame = RandomFrame(&random);
      ASSERT_EQ(sender->Send(frame), BusStatus::kOk);
    }
    for (const CanFrame& frame : frames) {
      CanFrame received;
      ASSERT_EQ(receiver->Receive(kForever_ns, &received), BusStatus::kOk);
      ASSERT_EQ(Describe(received), Describe(frame));
    }
  }
}

TEST_F(UdpBus, TheStampIsTheTimeOfReceptionNotOfTheCall) {
  constexpr int64_t kInQueue_ns = 20'000'000;
  const auto sender = Open();
  const auto receiver = Open();
  // Linux begins to stamp a moment after it is first asked to, hence several tries.
  bool stamped_on_reception = false;
  for (int tries = 0; tries < 100 && !stamped_on_reception; ++tries) {
    CanFrame received;
    const int64_t before_ns = Now_ns();
    ASSERT_EQ(sender->Send(DataFrame(0x29, {1})), BusStatus::kOk);
    EXPECT_EQ(sender->Receive(Now_ns() + kInQueue_ns, &received), BusStatus::kTimeout);
    const int64_t taken_ns = Now_ns();
    ASSERT_EQ(receiver->Receive(kPoll, &received), BusStatus::kOk);
    stamped_on_reception = received.stamp_ns >= before_ns && received.stamp_ns < taken_ns - kInQueue_ns / 2;
  }
  EXPECT_TRUE(stamped_on_reception);
}

TEST_F(UdpBus, ReceiveWaitsUntilItsDeadlineAndNotBefore) {
  const auto bus = Open();
  CanFrame received;
  const int64_t deadline_ns = Now_ns() + 3'700'000;
  EXPECT_EQ(bus->Receive(deadline_ns, &received), BusStatus::kTimeout);
  EXPECT_GE(Now_ns(), deadline_ns);
}

TEST_F(UdpBus, TheDescriptorTellsWhenInputIsThere) {
  const auto sender = Open();
  const auto receiver = Open();
  pollfd input{receiver->descriptor(), POLLIN, 0};
  EXPECT_EQ(poll(&input, 1, 0), 0);
  ASSERT_EQ(sender->Send(DataFrame(0x29, {1})), BusStatus::kOk);
  EXPECT_EQ(poll(&input, 1, -1), 1);
}

TEST_F(UdpBus, ErrorFramesAreCountedAndHandedOver) {
  const auto sender = Open();
  const auto receiver = Open();
  CanFrame bus_off = DataFrame(0x40, {0, 0, 0, 0, 0, 0, 0, 0});
  bus_off.error = true;
  ASSERT_EQ(sender->Send(bus_off), BusStatus::kOk);
  CanFrame received;
  ASSERT_EQ(receiver->Receive(kForever_ns, &received), BusStatus::kOk);
  EXPECT_TRUE(received.error);
  EXPECT_EQ(receiver->counters().errors, 1u);
}

TEST_F(UdpBus, AFrameNoBusCanCarryIsNotSent) {
  const auto sender = Open();
  const auto receiver = Open();
  EXPECT_EQ(sender->Send(DataFrame(0x800, {1})), BusStatus::kQueueFull);
  EXPECT_EQ(sender->counters().malformed, 1u);
  EXPECT_EQ(sender->counters().sent, 0u);
  CanFrame received;
  EXPECT_EQ(receiver->Receive(kPoll, &received), BusStatus::kTimeout);
}

TEST_F(UdpBus, MalformedDatagramsAreCountedAndSkipped) {
  const auto receiver = Open();
  const auto sender = Open();
  Stranger stranger;
  stranger.Send({});
  stranger.Send(std::array<uint8_t, 3>{1, 2, 3});
  stranger.Send(std::vector<uint8_t>(5000, 0xC0));  // more than the bus reads
  UdpFrameBuffer buffer;
  const size_t size = EncodeUdpFrame(DataFrame(0x29, {7}), 0.0, &buffer);
  stranger.Send({buffer.data(), size - 1});
  stranger.Send({buffer.data(), size});
  CanFrame received;
  ASSERT_EQ(receiver->Receive(kPoll, &received), BusStatus::kOk);
  EXPECT_EQ(Describe(received), Describe(DataFrame(0x29, {7})));
  EXPECT_EQ(receiver->counters().malformed, 4u);
  EXPECT_EQ(receiver->counters().received, 1u);
}

TEST_F(UdpBus, ADatagramTooLongToBeReadWholeIsMalformedEvenIfItsBeginningIsAFrame) {
  const auto receiver = Open();
  UdpFrameBuffer buffer;
  const size_t size = EncodeUdpFrame(DataFrame(0x29, {7}), 0.0, &buffer);
  std::vector<uint8_t> datagram(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(size));
  datagram[0] = 0x8C;  // one key more: "x", bytes up to the 1024 that are read
  const size_t filling = 1024 - size - 5;
  for (const size_t byte : {size_t{0xA1}, size_t{'x'}, size_t{0xC5}, filling >> 8, filling & 0xFF}) {
    datagram.push_back(static_cast<uint8_t>(byte));
  }
  datagram.resize(1024);
  Stranger stranger;
  stranger.Send(datagram);
  CanFrame received;
  EXPECT_EQ(receiver->Receive(kPoll, &received), BusStatus::kOk);
  datagram.push_back(0);
  stranger.Send(datagram);
  EXPECT_EQ(receiver->Receive(kPoll, &received), BusStatus::kTimeout);
  EXPECT_EQ(receiver->counters().malformed, 1u);
}

TEST_F(UdpBus, AFloodOfMalformedDatagramsDoesNotHoldAPoll) {
  const auto receiver = Open();
  Stranger stranger;
  for (int i = 0; i < 150; ++i) stranger.Send(std::array<uint8_t, 1>{0});
  CanFrame received;
  EXPECT_EQ(receiver->Receive(kPoll, &received), BusStatus::kTimeout);
  const uint64_t first = receiver->counters().malformed;
  EXPECT_GT(first, 0u);
  EXPECT_LT(first, 150u);
  while (receiver->counters().malformed < 150) {
    const uint64_t before = receiver->counters().malformed;
    EXPECT_EQ(receiver->Receive(kPoll, &received), BusStatus::kTimeout);
    ASSERT_GT(receiver->counters().malformed, before);
  }
}

TEST_F(UdpBus, OwnFramesInTheQueueDoNotHideOthers) {
  const auto bus = Open();
  const auto other = Open();
  for (int i = 0; i < 30; ++i) ASSERT_EQ(bus->Send(DataFrame(0x29, {1})), BusStatus::kOk);
  ASSERT_EQ(other->Send(DataFrame(0x2A, {2})), BusStatus::kOk);
  CanFrame received;
  ASSERT_EQ(bus->Receive(kPoll, &received), BusStatus::kOk);
  EXPECT_EQ(received.id, 0x2Au);
}

TEST_F(UdpBus, SendAndReceiveAllocateNothing) {
  const auto sender = Open();
  const auto receiver = Open();
  Stranger stranger;
  std::mt19937_64 random(2);
  CanFrame received;
  for (int i = 0; i < 100; ++i) {
    const CanFrame frame = RandomFrame(&random);
    stranger.Send(std::array<uint8_t, 2>{0x81, 0xA1});
    const LimitMalloc guard;
    ASSERT_EQ(sender->Send(frame), BusStatus::kOk);
    ASSERT_EQ(sender->Flush(kPoll), BusStatus::kOk);
    ASSERT_EQ(receiver->Receive(kForever_ns, &received), BusStatus::kOk);
    ASSERT_EQ(receiver->Receive(kPoll, &received), BusStatus::kTimeout);
    ASSERT_EQ(sender->Receive(kPoll, &received), BusStatus::kTimeout);
  }
  EXPECT_EQ(receiver->counters().received, 100u);
  EXPECT_EQ(receiver->counters().malformed, 100u);
}

TEST_F(UdpBus, APortHeldByAnotherProgramIsReported) {
  const UniqueFd holder(socket(AF_INET, SOCK_DGRAM, 0));
  sockaddr_in any{};
  any.sin_family = AF_INET;
  any.sin_port = htons(kPort);
  ASSERT_EQ(bind(holder.get(), reinterpret_cast<sockaddr*>(&any), sizeof any), 0);
  std::string error;
  EXPECT_EQ(OpenBus("udp:239.74.163.11:43113", {}, MachineClock::Get(), &error), nullptr);
  EXPECT_NE(error.find("udp:239.74.163.11:43113: cannot bind"), std::string::npos) << error;
  EXPECT_NE(error.find("Another program holds the port"), std::string::npos) << error;
}

TEST(UdpBusWithoutRoute, SaysHowToMakeOne) {
  ASSERT_EQ(EnterPrivateNetwork(MulticastRoute::kNo), "");
  std::string error;
  EXPECT_EQ(OpenBus("udp:239.74.163.11:43113", {}, MachineClock::Get(), &error), nullptr);
  EXPECT_NE(error.find("udp:239.74.163.11:43113"), std::string::npos) << error;
  EXPECT_NE(error.find("ip route add 224.0.0.0/4 dev lo"), std::string::npos) << error;
}

}  // namespace
}  // namespace armada
