// A board's 100 Hz loop on a vcan bus with emulated drives, and what it does when the bus or a drive fails.
// candump of can-utils is the witness of what was on the bus, and when.

#include <gtest/gtest.h>

#include <poll.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include "firmware/app/arm_loop.h"
#include "firmware/app/realtime.h"
#include "firmware/can/open_bus.h"
#include "firmware/clock/machine_clock.h"
#include "firmware/link/lcm_endpoint.h"
#include "hil/hil_server.h"
#include "hil/scenario_file.h"
#include "tests/support/numbers.h"
#include "tests/vcan/vcan_interface.h"

namespace armada {
namespace {

constexpr double kFault_s = 0.5;  // of the fleet's time
constexpr double kEnd_s = 0.8;

/// Waits for times, and for the bus of the drives.
class BusClock final : public HilClock {
 public:
  explicit BusClock(CanBus* bus) : bus_(bus) {}
  int64_t Now() override { return MonotonicNow(); }
  bool WaitUntil(int64_t deadline_ns) override {
    const int64_t left_ns = std::max<int64_t>(0, deadline_ns - Now());
    const timespec left{left_ns / 1'000'000'000, left_ns % 1'000'000'000};
    pollfd input{bus_->descriptor(), POLLIN, 0};
    ppoll(&input, 1, &left, nullptr);
    return !stop;
  }
  std::atomic<bool> stop = false;

 private:
  CanBus* bus_;
};

/// A drive's answers, as far as the bus between lets them through.
class FaultyBus final : public CanBus {
 public:
  explicit FaultyBus(std::unique_ptr<CanBus> bus) : bus_(std::move(bus)) {}
  BusStatus Send(const CanFrame& frame) override {
    CanFrame answer = frame;
    if (nonsense) answer.data.fill(0xFF);  // as floats: NaN
    return silent ? BusStatus::kOk : bus_->Send(answer);
  }
  BusStatus Flush(int64_t deadline_ns) override { return bus_->Flush(deadline_ns); }
  void DropWaiting() override { bus_->DropWaiting(); }
  BusStatus Receive(int64_t deadline_ns, CanFrame* frame) override {
    return bus_->Receive(deadline_ns, frame);
  }
  int descriptor() const override { return bus_->descriptor(); }

  std::atomic<bool> silent = false;
  std::atomic<bool> nonsense = false;

 private:
  std::unique_ptr<CanBus> bus_;
};

/// One line of candump's log.
struct Logged {
  double t_s;
  std::string id;
};

class BoardFaults : public testing::Test {
 protected:
  BoardFaults() {
    std::vector<ConfigError> errors;
    scenario_ = *LoadScenario("hil/scenarios/benign.toml", {}, &errors);
    scenario_.fleet.arms.resize(1);
    scenario_.fleet.arms[0].bus = interface_.bus();
    scenario_.fleet.topologies = {{{}, {{1, 1.0}}}};
    log_ = std::filesystem::temp_directory_path() / "candump.log";
    std::filesystem::remove(log_);
  }

  /// Runs the arm, and `fault` at kFault_s.
  void RunWith(const std::function<void(FaultyBus*)>& fault) {
    std::string error;
    const ArmEntry& arm = scenario_.fleet.arms[0];
    std::vector<std::unique_ptr<CanBus>> drive_buses;
    drive_buses.push_back(std::make_unique<FaultyBus>(OpenBus(arm.bus, {}, MachineClock::Get(), &error)));
    auto* drives = static_cast<FaultyBus*>(drive_buses[0].get());
    const auto bus = OpenBus(arm.bus, BusOptionsOf(arm), MachineClock::Get(), &error);
    const auto url = ParseLcmUrl(scenario_.fleet.link.lcm_url, &error);
    const auto link = LcmEndpoint::Open(*url, MachineClock::Get(), &error);
    ASSERT_TRUE(bus != nullptr && link != nullptr) << error;
    StartWitness();

    const int64_t epoch_ns = MonotonicNow() + 1000 * kMs;
    const LeaderPath leader(scenario_.leader);
    const ArmStart start = DrawStart(scenario_, 0, 1, &leader);
    BusClock clock(drives);
    HilServer bench(scenario_, 1, epoch_ns, drive_buses, {}, &clock);
    std::thread serve([&] { bench.Run(kEnd_s); });
    std::thread fail([&] {
      SleepUntil(epoch_ns + static_cast<int64_t>(kFault_s * 1e9));
      fault_wall_s_ = WallTime();
      fault(drives);
    });
    node_ = std::make_unique<ArmNode>(scenario_.fleet, 0, start.controller, epoch_ns,
                                      BoardStart{StartMode::kRunning, 0, std::nullopt});
    ArmLoop loop(node_.get(), bus.get(), link.get(), MachineClock::Get(), scenario_.fleet.timing, epoch_ns);
    const volatile std::sig_atomic_t never = 0;
    ASSERT_TRUE(loop.BringUp(&never)) << node_->ExplainDrives();
    loop.Run(epoch_ns + static_cast<int64_t>(kEnd_s * 1e9), &never);
    fail.join();
    clock.stop = true;
    serve.join();
    report_ = loop.report();
    counters_ = bus->counters();
    std::system(("kill $(cat " + log_.string() + ".pid)").c_str());
  }

  /// candump ends when the interface goes down.
  void StartWitness() {
    Shell("candump -L " + interface_.name() + ",0:0,#FFFFFFFF >> " + log_.string() + " & echo $! > " +
          log_.string() + ".pid");
  }
  static double WallTime() {
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  }

  std::vector<Logged> Log() const {
    std::vector<Logged> lines;
    std::ifstream file(log_);
    for (std::string stamp, channel, frame; file >> stamp >> channel >> frame;) {
      lines.push_back({std::stod(stamp.substr(1)), frame.substr(0, frame.find('#'))});
    }
    return lines;
  }
  /// The time from the fault to the last torque that was on the bus.
  double LastTorqueAfterFault_s() const {
    double last_s = 0.0;
    for (const Logged& line : Log()) {
      if (line.id == "02E" || line.id == "04E") last_s = line.t_s;  // nodes 1 and 2, set input torque
    }
    return last_s - fault_wall_s_;
  }
  void ExpectFault(Cause cause) {
    EXPECT_STREQ(NameOf(node_->cause()), NameOf(cause));
    EXPECT_EQ(node_->state(), ControllerState::kFault);
  }

  static constexpr double kTwoTicks_s = 0.02;

  VcanInterface interface_{"vcan0"};
  ScenarioConfig scenario_;
  std::filesystem::path log_;
  double fault_wall_s_ = 0.0;
  std::unique_ptr<ArmNode> node_;
  LoopReport report_;
  BusCounters counters_;
};

TEST_F(BoardFaults, WithoutAFaultTorquesFlowToTheEnd) {
  RunWith([](FaultyBus*) {});
  EXPECT_EQ(node_->cause(), Cause::kNone);
  EXPECT_NEAR(LastTorqueAfterFault_s(), kEnd_s - kFault_s, kTwoTicks_s);
  EXPECT_EQ(report_.unsent_ticks, 0);
  EXPECT_EQ(report_.missed_ticks, 0);
}

TEST_F(BoardFaults, BusOffEndsTheTorquesWithinTwoTicks) {
  RunWith([&](FaultyBus*) { interface_.InjectError(kBusOff); });
  ExpectFault(Cause::kBusOff);
  EXPECT_LE(LastTorqueAfterFault_s(), kTwoTicks_s);
  EXPECT_EQ(counters_.bus_off, 1u);
}

TEST_F(BoardFaults, ARestartOfTheControllerEndsTheTorquesWithinTwoTicks) {
  RunWith([&](FaultyBus*) { interface_.InjectError(kRestarted); });
  ExpectFault(Cause::kBusRestarted);
  EXPECT_LE(LastTorqueAfterFault_s(), kTwoTicks_s);
}

TEST_F(BoardFaults, ErrorPassiveIsCountedAndTheArmGoesOnDegraded) {
  RunWith([&](FaultyBus*) { interface_.InjectError(kTxPassive); });
  EXPECT_EQ(node_->state(), ControllerState::kDegraded);
  EXPECT_EQ(node_->cause(), Cause::kErrorPassive);
  EXPECT_EQ(counters_.error_passive, 1u);
  EXPECT_GT(LastTorqueAfterFault_s(), 0.2);
}

TEST_F(BoardFaults, ALinkThatGoesDownEndsTheTorquesForGood) {
  RunWith([&](FaultyBus*) {
    interface_.SetDown();
    SleepUntil(MonotonicNow() + 50 * kMs);
    interface_.SetUp();
    StartWitness();
  });
  ExpectFault(Cause::kBusDown);
  EXPECT_LE(LastTorqueAfterFault_s(), kTwoTicks_s) << "nothing old, and nothing new, after it is up again";
}

TEST_F(BoardFaults, AFullQueueEndsTheTorques) {
  RunWith([&](FaultyBus*) { interface_.Delay(200, 2); });
  EXPECT_TRUE(node_->state() == ControllerState::kFault || node_->state() == ControllerState::kSafeStop);
  EXPECT_TRUE(node_->cause() == Cause::kTorquesUnsent || node_->cause() == Cause::kFeedbackStale)
      << NameOf(node_->cause());
  EXPECT_GT(counters_.dropped_queue_full + counters_.dropped_late, 0u);
  EXPECT_GT(report_.unsent_ticks, 0);
}

TEST_F(BoardFaults, ADriveThatFallsSilentIsMissedInTheNextTick) {
  RunWith([&](FaultyBus* drives) { drives->silent = true; });
  ExpectFault(Cause::kFeedbackStale);
  EXPECT_GE(report_.incomplete_samples, 2);
  EXPECT_LE(LastTorqueAfterFault_s(), scenario_.fleet.timing.feedback_stale_s + kTwoTicks_s);
}

TEST_F(BoardFaults, ADriveThatAnswersNonsenseIsNotBelieved) {
  RunWith([&](FaultyBus* drives) { drives->nonsense = true; });
  EXPECT_GT(node_->malformed_frames(), 0);
  EXPECT_EQ(node_->state(), ControllerState::kFault);
  EXPECT_LE(LastTorqueAfterFault_s(), scenario_.fleet.timing.feedback_stale_s + kTwoTicks_s);
}

}  // namespace
}  // namespace armada
