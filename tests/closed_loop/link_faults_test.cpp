#include "host/sim/link_faults.h"

#include <gtest/gtest.h>

#include "firmware/link/channels.h"
#include "firmware/link/seal.h"
#include "tests/closed_loop/fault_at_one.h"

namespace armada {
namespace {

constexpr int64_t kTick = 200;  // 2 s, when every fault here holds

LinkFaults Link(const FaultConfig& fault) {
  ScenarioConfig scenario;
  scenario.faults = {fault};
  return {scenario, 7};
}

/// Messages that say in which tick they were sent, as one byte.
std::vector<int> TicksThatArrive(const LinkFaults& link, int64_t k) {
  std::vector<int> ticks;
  std::array<uint8_t, 256> bytes;
  for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<uint8_t>(i);
  link.Deliver(
      1, 2, k,
      [&](int64_t age) { return LinkFaults::Payload(bytes).subspan(static_cast<size_t>(k - age), 1); },
      [&](LinkFaults::Payload payload) { ticks.push_back(payload[0]); });
  return ticks;
}

TEST(LinkFaults, PartitionCutsANodeOffBothWays) {
  const LinkFaults link = Link(FaultAtOne(FaultKind::kPartition, 0.0, 2));
  EXPECT_TRUE(link.Loses(0, 2, kTick));
  EXPECT_TRUE(link.Loses(2, 4, kTick));
  EXPECT_FALSE(link.Loses(0, 4, kTick));
  EXPECT_FALSE(link.Loses(0, 2, 99));
  EXPECT_FALSE(link.Loses(0, 2, 300));
}

TEST(LinkFaults, LossTakesItsShareOfEachLinkOnItsOwn) {
  const LinkFaults link = Link(FaultAtOne(FaultKind::kLinkLoss, 0.3));
  int lost = 0;
  int alike = 0;
  for (int64_t k = 100; k < 300; ++k) {
    for (int other = 2; other < 12; ++other) lost += link.Loses(1, other, k) ? 1 : 0;
    alike += link.Loses(1, 2, k) == link.Loses(1, 3, k) ? 1 : 0;
  }
  EXPECT_NEAR(lost, 600, 60);
  EXPECT_LT(alike, 150);
}

TEST(LinkFaults, ReorderedMessagesComeInPairsTheNewerFirst) {
  const LinkFaults link = Link(FaultAtOne(FaultKind::kReorder));
  EXPECT_EQ(link.history(), 1);
  EXPECT_EQ(TicksThatArrive(link, 50), (std::vector<int>{50}));
  EXPECT_EQ(TicksThatArrive(link, 200), (std::vector<int>{}));
  EXPECT_EQ(TicksThatArrive(link, 201), (std::vector<int>{201, 200}));
}

TEST(LinkFaults, ReplayedMessagesComeBesideTheNewOnes) {
  const LinkFaults link = Link(FaultAtOne(FaultKind::kReplay, 0.5));
  EXPECT_EQ(link.history(), 50);
  EXPECT_EQ(TicksThatArrive(link, 200), (std::vector<int>{200, 150}));
}

TEST(LinkFaults, JunkComesAtItsRate) {
  const LinkFaults link = Link(FaultAtOne(FaultKind::kJunk, 1550.0));
  int messages = 0;
  for (int64_t k = 100; k < 200; ++k) {
    link.Deliver(
        1, 2, k, [](int64_t) { return LinkFaults::Payload(); }, [&](LinkFaults::Payload) { ++messages; });
  }
  EXPECT_EQ(messages, 1550 + 100);  // and what the sender sent
}

// Before each message comes one that says something else under its seal; the check of seals tells them apart.
TEST(LinkFaults, AForgedMessageHasTheSealOfAnother) {
  const LinkFaults link = Link(FaultAtOne(FaultKind::kForge, 0.1, 0));
  const LinkIdentity identity{.key = {1, 2, 3}, .epoch = 1};
  Sealer sealer(identity, kLeaderSender);
  SealCheck check(identity.key, kLeaderSender);
  leader_t message{};
  message.stamp_ns = message.sequence = 1;
  message.task_dim = 2;
  message.x_m[0] = 1.5;
  MessageBuffer buffer;
  const auto sealed = sealer.Seal(kLeaderChannel, Encode(message, &buffer), &buffer);
  std::vector<SealVerdict> verdicts;
  std::vector<double> positions_m;
  link.Deliver(
      0, 2, kTick, [&](int64_t) { return sealed; },
      [&](LinkFaults::Payload payload) {
        leader_t heard;
        EXPECT_TRUE(Decode(payload.first(payload.size() - kSealSize), &heard));
        positions_m.push_back(heard.x_m[0]);
        verdicts.push_back(check.Open(kLeaderChannel, &payload));
      });
  EXPECT_EQ(positions_m, (std::vector<double>{1.6, 1.5}));
  EXPECT_EQ(verdicts, (std::vector<SealVerdict>{SealVerdict::kForged, SealVerdict::kGenuine}));
}

}  // namespace
}  // namespace armada
