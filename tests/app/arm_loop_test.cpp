// A board's loop on a real LCM network; its loop on a real CAN bus is tested in tests/vcan.

#include "firmware/app/arm_loop.h"

#include <gtest/gtest.h>

#include "firmware/app/initial_state.h"
#include "firmware/app/realtime.h"
#include "firmware/clock/machine_clock.h"
#include "hil/scenario_file.h"
#include "tests/link/private_network_fixture.h"

namespace armada {
namespace {

/// A bus without drives; whenever the loop has sent its frames, the leader has spoken `kBurst` times.
class TalkativeBus final : public CanBus {
 public:
  static constexpr int kBurst = 100;

  explicit TalkativeBus(LcmEndpoint* leader) : leader_(leader) {}
  BusStatus Send(const CanFrame&) override { return BusStatus::kOk; }
  BusStatus Flush(int64_t) override {
    std::array<uint8_t, 129> state{};
    for (int i = 0; i < kBurst; ++i) leader_->Publish("LEADER", state);
    return BusStatus::kOk;
  }
  void DropWaiting() override {}
  BusStatus Receive(int64_t, CanFrame*) override { return BusStatus::kTimeout; }
  int descriptor() const override { return -1; }

 private:
  LcmEndpoint* leader_;
};

class ArmLoopTest : public PrivateNetworkTest {};

// The time to bring drives up may be a minute, in which leader and neighbours go on speaking.
TEST_F(ArmLoopTest, NoMessageIsLostWhileTheDrivesComeUp) {
  std::vector<ConfigError> errors;
  const auto scenario = LoadScenario(ARMADA_SOURCE_DIR "/hil/scenarios/benign.toml", {}, &errors);
  ASSERT_TRUE(errors.empty());
  std::string error;
  const auto leader = LcmEndpoint::Open(LcmUrl(), MachineClock::Get(), &error);
  const auto link = LcmEndpoint::Open(LcmUrl(), MachineClock::Get(), &error);
  ASSERT_TRUE(leader != nullptr && link != nullptr) << error;

  const int64_t epoch_ns = MonotonicNow() + 200'000'000;
  ArmNode node(scenario->fleet, 0, NominalInitialState(scenario->fleet.arms[0]), epoch_ns, {});
  TalkativeBus bus(leader.get());
  ArmLoop loop(&node, &bus, link.get(), MachineClock::Get(), scenario->fleet.timing, epoch_ns);
  const volatile std::sig_atomic_t never = 0;
  EXPECT_FALSE(loop.BringUp(&never)) << "there are no drives";

  link->Drain([](const LcmMessage&) {});
  EXPECT_GE(leader->counters().sent, 1000u) << "more than the kernel's queue takes";
  EXPECT_EQ(link->counters().received, leader->counters().sent);
  EXPECT_EQ(link->counters().overflowed, 0u);
}

}  // namespace
}  // namespace armada
