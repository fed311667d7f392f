#include "hil/hil_server.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>

#include "firmware/can/odrive_messages.h"
#include "hil/active_drive.h"
#include "tests/support/limit_malloc.h"

namespace armada {
namespace {

constexpr int64_t kMs = 1'000'000;
constexpr int64_t kEpoch_ns = 100'000 * kMs;

class FakeClock;

/// A bus in memory: what is to come at which time, and what was sent.
class MemoryBus final : public CanBus {
 public:
  struct Sent {
    int64_t at_ns;
    CanFrame frame;
  };

  explicit MemoryBus(const FakeClock* clock) : clock_(clock) { sent.reserve(20'000); }

  void Schedule(int64_t at_ns, CanFrame frame) {
    frame.stamp_ns = at_ns;
    coming_.push_back(frame);
  }
  int64_t NextArrival() const { return next_ < coming_.size() ? coming_[next_].stamp_ns : INT64_MAX; }

  BusStatus Send(const CanFrame& frame) override;
  BusStatus Flush(int64_t) override { return BusStatus::kOk; }
  void DropWaiting() override {}
  BusStatus Receive(int64_t deadline_ns, CanFrame* frame) override;
  int descriptor() const override { return -1; }

  std::vector<Sent> sent;
  int64_t down_from_ns = INT64_MAX;

 private:
  const FakeClock* clock_;
  std::vector<CanFrame> coming_;
  size_t next_ = 0;
};

/// Time that passes in waits only: a wait ends at its deadline or with the next frame, later by
/// lateness(then).
class FakeClock final : public HilClock {
 public:
  int64_t Now() override { return now_ns; }
  bool WaitUntil(int64_t deadline_ns) override {
    for (const MemoryBus* bus : buses) deadline_ns = std::min(deadline_ns, bus->NextArrival());
    const int64_t wake_ns = std::max(now_ns, deadline_ns);
    now_ns = wake_ns + lateness(wake_ns);
    return now_ns < stop_ns;
  }

  int64_t now_ns = kEpoch_ns - 1000 * kMs;
  int64_t stop_ns = INT64_MAX;
  std::function<int64_t(int64_t)> lateness = [](int64_t) { return 0; };
  std::vector<const MemoryBus*> buses;
};

BusStatus MemoryBus::Send(const CanFrame& frame) {
  if (clock_->now_ns >= down_from_ns) return BusStatus::kDown;
  ++counters_.sent;
  sent.push_back({clock_->now_ns, frame});
  return BusStatus::kOk;
}

BusStatus MemoryBus::Receive(int64_t, CanFrame* frame) {
  if (clock_->now_ns >= down_from_ns) return BusStatus::kDown;
  if (NextArrival() > clock_->now_ns) return BusStatus::kTimeout;
  *frame = coming_[next_++];
  ++counters_.received;
  return BusStatus::kOk;
}

/// Two arms with drives that do not time out: arm 3 with one joint, arm 8 with two.
ScenarioConfig ServedScenario() {
  ScenarioConfig scenario;
  scenario.seconds = 2.0;
  scenario.window_start_s = 0.5;
  scenario.leader.axes = {{0.5, 0.2, 0.5, 0.0}, {0.5, 0.2, 0.5, 1.0}};
  scenario.start.dq_range_rad_s = 0.5;
  scenario.drive.watchdog_s = 0.0;
  for (const int dof : {1, 2}) {
    ArmEntry arm;
    arm.id = dof == 1 ? 3 : 8;
    arm.bus = "bus of arm " + std::to_string(arm.id);
    arm.arm.dof = dof;
    for (int i = 0; i < dof; ++i) {
      arm.arm.links[static_cast<size_t>(i)] = {2.0, 1.0, 0.5, 1.5};
      arm.joints.push_back({.node_id = i + 1, .torque_limit_Nm = 100.0});
    }
    scenario.fleet.arms.push_back(arm);
  }
  return scenario;
}

/// The scenario's server between two buses in memory.
class Rig {
 public:
  Rig() {
    for (int i = 0; i < 2; ++i) {
      auto bus = std::make_unique<MemoryBus>(&clock);
      clock.buses.push_back(bus.get());
      buses.push_back(std::move(bus));
    }
  }

  MemoryBus& Bus(size_t arm) { return static_cast<MemoryBus&>(*buses[arm]); }
  HilServer& Start() {
    server_ = std::make_unique<HilServer>(scenario, seed, kEpoch_ns, buses, logs, &clock);
    return *server_;
  }

  /// What a board sends to bring its drives up.
  void EnableAt(int64_t at_ns, size_t arm) {
    for (const JointDriveConfig& joint : scenario.fleet.arms[arm].joints) {
      Bus(arm).Schedule(at_ns,
                        odrive::EncodeSetControllerMode(
                            joint.node_id, {odrive::ControlMode::kTorque, odrive::InputMode::kPassthrough}));
      Bus(arm).Schedule(at_ns, odrive::EncodeSetAxisState(joint.node_id, odrive::AxisState::kClosedLoop));
    }
  }
  /// A board's traffic from 0.5 s before the epoch on: torques that sway, off the millisecond grid, and
  /// requests.
  void ScheduleBoard(size_t arm) {
    EnableAt(kEpoch_ns - 500 * kMs, arm);
    const auto& joints = scenario.fleet.arms[arm].joints;
    for (int64_t t_ns = kEpoch_ns + 300'000; t_ns < kEpoch_ns + 2000 * kMs; t_ns += 10 * kMs) {
      for (const auto& joint : joints) Bus(arm).Schedule(t_ns, odrive::EncodeEncoderRequest(joint.node_id));
      for (const auto& joint : joints) {
        const double phase = 1e-9 * static_cast<double>(t_ns - kEpoch_ns) * (2.0 + joint.node_id);
        const auto tau_Nm = static_cast<float>(20.0 * std::sin(phase));
        Bus(arm).Schedule(t_ns + 70'000, odrive::EncodeSetInputTorque(joint.node_id, tau_Nm));
      }
    }
  }
  std::vector<MemoryBus::Sent> SentBy(size_t arm, int node, odrive::Command wanted) {
    std::vector<MemoryBus::Sent> found;
    for (const MemoryBus::Sent& sent : Bus(arm).sent) {
      odrive::Command command{};
      if (odrive::IsForNode(sent.frame, node, &command) && command == wanted) found.push_back(sent);
    }
    return found;
  }

  ScenarioConfig scenario = ServedScenario();
  uint64_t seed = 5;
  FakeClock clock;
  std::vector<std::unique_ptr<CanBus>> buses;
  std::vector<CanLog*> logs;

 private:
  std::unique_ptr<HilServer> server_;
};

TEST(HilServer, EndsAtItsTimeWithOneSampleAMillisecondOfTheWindow) {
  Rig rig;
  HilServer& server = rig.Start();
  EXPECT_EQ(server.Run(2.0), HilEnd::kDone);
  EXPECT_EQ(rig.clock.now_ns, kEpoch_ns + 2000 * kMs);
  EXPECT_DOUBLE_EQ(server.time_s(), 2.0);
  ASSERT_EQ(server.Results().size(), 2u);
  for (const HilArmResult& arm : server.Results())
    EXPECT_EQ(arm.record->count(), 1501);  // 0.5 s to 2 s, both
}

TEST(HilServer, MeasuresTheArmAtTheStartStateOfItsSeed) {
  Rig rig;
  HilServer& server = rig.Start();
  server.Run(2.0);
  const LeaderPath leader(rig.scenario.leader);
  for (size_t i = 0; i < 2; ++i) {
    PlanarPlant plant(rig.scenario.fleet.arms[i].arm);
    plant.q_rad = DrawStart(rig.scenario, i, rig.seed, &leader).q_rad;
    const auto x_m = plant.EndEffector().x_m;  // nobody enabled the drives: it stands on its brakes
    double max_m = 0.0;
    for (int k = 500; k <= 2000; ++k) {
      const TaskVector target_m = leader.At(k / 1000.0).x_m;
      max_m = std::max(max_m, std::hypot(x_m[0] - target_m[0], x_m[1] - target_m[1]));
    }
    EXPECT_NEAR(server.Results()[i].record->max_m(), max_m, 1e-12);
  }
}

TEST(HilServer, AnswersARequestAtOnceWithTheTruePosition) {
  Rig rig;
  const int64_t asked_ns = kEpoch_ns - 400 * kMs + 123'456;
  rig.Bus(1).Schedule(asked_ns, odrive::EncodeEncoderRequest(2));
  rig.Start().Run(0.1);
  const auto answers = rig.SentBy(1, 2, odrive::Command::kEncoderEstimates);
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers[0].at_ns, asked_ns);
  odrive::EncoderEstimates estimates;
  ASSERT_TRUE(odrive::DecodeEncoderEstimates(answers[0].frame, 2, &estimates));
  const LeaderPath leader(rig.scenario.leader);
  EXPECT_NEAR(estimates.position_turns * 2.0 * M_PI, DrawStart(rig.scenario, 1, rig.seed, &leader).q_rad[1],
              1e-6);
  EXPECT_TRUE(rig.SentBy(0, 2, odrive::Command::kEncoderEstimates).empty());
}

TEST(HilServer, SendsEveryDrivesHeartbeatTenTimesASecond) {
  Rig rig;
  rig.Start().Run(2.0);
  for (const int node : {1, 2}) {
    const auto heartbeats = rig.SentBy(1, node, odrive::Command::kHeartbeat);
    ASSERT_EQ(heartbeats.size(), 31u);  // from -1 s to 2 s, both
    for (size_t i = 1; i < heartbeats.size(); ++i) {
      EXPECT_NEAR(static_cast<double>(heartbeats[i].at_ns - heartbeats[i - 1].at_ns), 100.0 * kMs, 1.0 * kMs);
    }
  }
}

TEST(HilServer, LetsAnArmGoAtTheEpochOrWhenItsDrivesAreReady) {
  Rig rig;
  rig.EnableAt(kEpoch_ns - 500 * kMs, 0);
  rig.EnableAt(kEpoch_ns + 250 * kMs, 1);
  HilServer& server = rig.Start();
  server.Run(1.0);
  ASSERT_TRUE(server.Results()[0].released_s && server.Results()[1].released_s);
  EXPECT_DOUBLE_EQ(*server.Results()[0].released_s, 0.0);
  EXPECT_DOUBLE_EQ(*server.Results()[1].released_s, 0.25);
}

TEST(HilServer, NeverLetsAnArmGoThatNobodyEnables) {
  Rig rig;
  HilServer& server = rig.Start();
  server.Run(1.0);
  EXPECT_FALSE(server.Results()[0].released_s.has_value());
}

// The same frames, once served on time and once by a process that is held up for up to 40 ms again and again.
TEST(HilServer, ComputesTheSameMotionWhenItIsLate) {
  Rig rig;
  for (size_t arm = 0; arm < 2; ++arm) rig.ScheduleBoard(arm);
  HilServer& server = rig.Start();
  server.Run(2.0);
  const std::vector<HilArmResult> on_time = server.Results();
  EXPECT_EQ(server.pacing().max_us(), 0.0);

  Rig late;
  for (size_t arm = 0; arm < 2; ++arm) late.ScheduleBoard(arm);
  late.clock.lateness = [](int64_t t_ns) {
    return t_ns / kMs % 7 == 0 ? 40 * kMs - t_ns % 9973 : t_ns % 331'000;
  };
  HilServer& late_server = late.Start();
  late_server.Run(2.0);
  EXPECT_GT(late_server.pacing().max_us(), 30'000.0);
  EXPECT_GE(late_server.pacing().count(), 3000);
  for (size_t i = 0; i < 2; ++i) {
    ASSERT_TRUE(on_time[i].released_s.has_value());
    const HilArmResult result = late_server.Results()[i];
    EXPECT_EQ(result.record->count(), on_time[i].record->count());
    EXPECT_NEAR(result.record->rms_m(), on_time[i].record->rms_m(), 1e-6);
    EXPECT_NEAR(result.record->max_m(), on_time[i].record->max_m(), 1e-6);
    EXPECT_EQ(result.counters.received, on_time[i].counters.received);
  }
}

TEST(HilServer, CountsHowLateItServesEachMillisecond) {
  Rig rig;
  rig.clock.lateness = [](int64_t t_ns) { return t_ns == kEpoch_ns ? 5 * kMs + 300'000 : 200'000; };
  HilServer& server = rig.Start();
  server.Run(0.5);
  EXPECT_EQ(server.pacing().count(), 1500);
  EXPECT_DOUBLE_EQ(server.pacing().max_us(), 5300.0);
  EXPECT_DOUBLE_EQ(server.pacing().PercentileUs(0.5), 200.0);
}

TEST(HilServer, TakesAFrameWithAnOldStampAtTheTimeItHasReached) {
  Rig rig;
  CanFrame request = odrive::EncodeEncoderRequest(1);
  rig.Bus(0).Schedule(kEpoch_ns - 100 * kMs, request);
  rig.Bus(0).Schedule(kEpoch_ns - 300 * kMs, request);  // came later, stamped earlier
  HilServer& server = rig.Start();
  EXPECT_EQ(server.Run(0.5), HilEnd::kDone);
  EXPECT_EQ(rig.SentBy(0, 1, odrive::Command::kEncoderEstimates).size(), 2u);
}

TEST(HilServer, EndsWhenAskedToAndKeepsWhatItMeasured) {
  Rig rig;
  rig.clock.stop_ns = kEpoch_ns + 800 * kMs + 500'000;
  rig.clock.lateness = [](int64_t) { return 700'000; };
  HilServer& server = rig.Start();
  EXPECT_EQ(server.Run(2.0), HilEnd::kStopped);
  EXPECT_NEAR(server.time_s(), 0.8, 0.001);
  EXPECT_NEAR(static_cast<double>(server.Results()[0].record->count()), 300.0, 1.0);
}

TEST(HilServer, EndsWhenABusGoesDown) {
  Rig rig;
  rig.Bus(1).down_from_ns = kEpoch_ns + 700 * kMs;
  HilServer& server = rig.Start();
  EXPECT_EQ(server.Run(2.0), HilEnd::kBusDown);
  EXPECT_NEAR(server.time_s(), 0.7, 0.002);
  EXPECT_FALSE(server.Results()[0].bus_down);
  EXPECT_TRUE(server.Results()[1].bus_down);
}

TEST(HilServer, MeasuresNothingWithoutALeader) {
  Rig rig;
  rig.scenario.leader.kind = LeaderKind::kNone;
  HilServer& server = rig.Start();
  EXPECT_EQ(server.Run(1.0), HilEnd::kDone);
  EXPECT_FALSE(server.Results()[0].record.has_value());
}

TEST(HilServer, LogsTheFramesOfBothSidesInOrder) {
  const std::string path = testing::TempDir() + "hil_server_test_" + std::to_string(getpid()) + ".log";
  std::string error;
  const auto log = CanLog::Create(path, "can8", 0, &error);
  ASSERT_NE(log, nullptr) << error;
  Rig rig;
  rig.logs = {nullptr, log.get()};
  rig.clock.lateness = [](int64_t t_ns) { return t_ns % (3 * kMs); };
  rig.ScheduleBoard(1);
  HilServer& server = rig.Start();
  server.Run(2.0);
  log->WriteOut();
  std::ifstream file(path);
  std::vector<double> stamps_s;
  for (std::string line; std::getline(file, line);) stamps_s.push_back(std::stod(line.substr(1)));
  std::filesystem::remove(path);
  const BusCounters counters = server.Results()[1].counters;
  EXPECT_EQ(counters.received, 4u + 4 * 200);
  EXPECT_EQ(stamps_s.size(), counters.sent + counters.received);
  EXPECT_TRUE(std::is_sorted(stamps_s.begin(), stamps_s.end()));
}

TEST(HilServer, AllocatesNothingWhileItRuns) {
  Rig rig;
  for (size_t arm = 0; arm < 2; ++arm) rig.ScheduleBoard(arm);
  HilServer& server = rig.Start();
  const LimitMalloc guard;
  server.Run(2.0);
}

TEST(HilServer, HearsADriveThatIsActiveBeforeTheStart) {
  Rig rig;
  rig.Bus(1).Schedule(rig.clock.now_ns + 20 * kMs, odrive::EncodeEncoderRequest(1));
  rig.Bus(1).Schedule(rig.clock.now_ns + 90 * kMs, odrive::EncodeHeartbeat(2, odrive::Firmware::kV06, {}));
  const auto drive = FindActiveDrive(ServedScenario().fleet, rig.buses, 150 * kMs, &rig.clock);
  ASSERT_TRUE(drive.has_value());
  EXPECT_EQ(drive->bus, 1u);
  EXPECT_EQ(drive->node_id, 2);
}

TEST(HilServer, HearsNoDriveInTheFramesOfABoard) {
  Rig rig;
  rig.ScheduleBoard(0);
  rig.Bus(0).Schedule(rig.clock.now_ns + 151 * kMs, odrive::EncodeHeartbeat(1, odrive::Firmware::kV06, {}));
  const int64_t start_ns = rig.clock.now_ns;
  EXPECT_FALSE(FindActiveDrive(ServedScenario().fleet, rig.buses, 150 * kMs, &rig.clock).has_value());
  EXPECT_EQ(rig.clock.now_ns - start_ns, 150 * kMs);
}

}  // namespace
}  // namespace armada
