// armada-hil as a process on the user-space bus, in a network of its own.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>

#include "firmware/app/exit_codes.h"
#include "firmware/app/realtime.h"
#include "firmware/can/odrive_cansimple.h"
#include "firmware/can/open_bus.h"
#include "firmware/clock/machine_clock.h"
#include "host/private_network.h"
#include "host/process_group.h"
#include "tests/hil/command_output.h"

namespace armada {
namespace {

constexpr char kBus[] = "udp:239.74.163.99:43199";
constexpr std::chrono::seconds kPatience{20};  // reached only when something hangs
constexpr int64_t kPatience_ns = 20'000'000'000;

constexpr char kFleet[] = R"(
name = "one"
[[arm]]
id = 4
bus = "udp:239.74.163.99:43199"
drive = "odrive_cansimple"
torque_limit_Nm = 150.0
link = [
  { m_kg = 0.8, l_m = 1.4, r_m = 0.8, I_kgm2 = 6.0 },
  { m_kg = 0.6, l_m = 0.9, r_m = 0.45, I_kgm2 = 3.0 },
]
[[graph]]
pins = [4]
edges = []
)";

// Drives without a watchdog: how long this test is held up must not matter.
constexpr char kProcessScenario[] = R"(
name = "one"
fleet = "fleet.toml"
seconds = 100.0
window_start_s = 0.0
[leader]
kind = "sine"
axis = [{ offset_m = 1.0, amplitude_m = 0.1, frequency_hz = 0.5 }, { offset_m = 1.0 }]
[start]
kind = "near_leader"
[disturbance]
kind = "none"
[drive]
watchdog_s = 0.2
)";

/// The board's side of the arm: both drives, on a bus object of its own.
class Board {
 public:
  Board() {
    std::string error;
    bus_ = OpenBus(kBus, {}, MachineClock::Get(), &error);
    EXPECT_NE(bus_, nullptr) << error;
  }

  /// Does `action` every 10 ms, and takes what comes in, until `done`.
  bool Until(const std::function<bool()>& done, const std::function<void(FrameList*)>& action) {
    const int64_t end_ns = MonotonicNow() + kPatience_ns;
    for (int64_t tick_ns = MonotonicNow(); tick_ns < end_ns; tick_ns += 10'000'000) {
      FrameList out;
      action(&out);
      for (const CanFrame& frame : out) EXPECT_EQ(bus_->Send(frame), BusStatus::kOk);
      CanFrame frame;
      while (bus_->Receive(tick_ns + 10'000'000, &frame) == BusStatus::kOk) {
        for (ODriveCanSimple& drive : drives) drive.OnFrame(frame);
      }
      if (done()) return true;
    }
    return false;
  }
  bool UntilHeard() {
    return Until([this] { return drives[0].state() != DriveState::kUnknown; }, [](FrameList*) {});
  }

  std::array<ODriveCanSimple, 2> drives = {ODriveCanSimple({.node_id = 1, .torque_limit_Nm = 150.0}),
                                           ODriveCanSimple({.node_id = 2, .torque_limit_Nm = 150.0})};

 private:
  std::unique_ptr<CanBus> bus_;
};

class HilProcessTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string error;
    ASSERT_TRUE(EnterPrivateNetwork(&error)) << error;
    std::string pattern = testing::TempDir() + "hil_process_XXXXXX";
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    std::ofstream(folder_ / "fleet.toml") << kFleet;
    std::ofstream(folder_ / "scenario.toml") << kProcessScenario;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string Scenario() const { return folder_ / "scenario.toml"; }
  std::string Out(const std::string& name = "") const { return folder_ / "out" / name; }

  void Start(const std::string& name, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), ARMADA_HIL);
    std::string error;
    ASSERT_TRUE(group_.Start(
        {.name = name, .argv = std::move(arguments), .environment = {}, .log_path = LogPath(name)}, &error))
        << error;
  }
  /// Code with which the next process ends by itself, -1 for none.
  int ExitCode() {
    const auto exit = group_.Poll(kPatience);
    return exit && WIFEXITED(exit->wait_status) ? WEXITSTATUS(exit->wait_status) : -1;
  }
  std::string Said(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(LogPath(name)).rdbuf();
    return text.str();
  }
  nlohmann::json Report() const { return nlohmann::json::parse(std::ifstream(Out("hil.json"))); }

  ProcessGroup group_;
  std::filesystem::path folder_;

 private:
  std::string LogPath(const std::string& name) const { return folder_ / (name + ".log"); }
};

TEST_F(HilProcessTest, IsAnArmThatABoardBringsUpAndMoves) {
  Start("hil", {Scenario(), "--out", Out()});
  Board board;
  const auto in_torque = [&] {
    return board.drives[0].state() == DriveState::kTorque && board.drives[1].state() == DriveState::kTorque;
  };
  ASSERT_TRUE(board.Until(in_torque, [&](FrameList* out) {
    for (ODriveCanSimple& drive : board.drives) drive.BringUp(MonotonicNow(), out);
  })) << Said("hil");

  const auto request = [&](FrameList* out) {
    for (ODriveCanSimple& drive : board.drives) drive.RequestSample(MonotonicNow(), out);
  };
  ASSERT_TRUE(board.Until([&] { return board.drives[1].sample().sequence > 0; }, request));
  const double start_rad = board.drives[0].sample().position_rad;
  const auto has_turned = [&] { return board.drives[0].sample().position_rad > start_rad + 0.2; };
  ASSERT_TRUE(board.Until(has_turned, [&](FrameList* out) {
    request(out);
    board.drives[0].CommandTorque(30.0, out);
  }));
  EXPECT_GT(board.drives[0].sample().velocity_rad_s, 0.0);

  const std::vector<ProcessExit> exits = group_.StopAll(kPatience);
  ASSERT_EQ(exits.size(), 1u);
  EXPECT_EQ(exits[0].Code(), kExitInterrupted) << exits[0].Describe();

  const nlohmann::json report = Report();
  EXPECT_EQ(report["end"], "stopped");
  const nlohmann::json arm = report["arms"].at(0);
  EXPECT_EQ(arm["id"], 4);
  EXPECT_EQ(arm["diverged"], false);
  EXPECT_GE(arm["released_s"].get<double>(), 0.0);
  EXPECT_GT(arm["rms_mm"].get<double>(), 0.0);
  EXPECT_NEAR(arm["samples"].get<double>(), 1000.0 * report["seconds"].get<double>(), 1.0);
  EXPECT_EQ(arm["can_log"]["dropped"], 0);
  EXPECT_EQ(arm["can_log"]["frames"],
            arm["bus"]["can_sent"].get<int64_t>() + arm["bus"]["can_received"].get<int64_t>());
  EXPECT_GE(report["timing"]["ticks"].get<double>(), 1000.0 * report["seconds"].get<double>());
  if (const auto heap = report["memory"]["heap_allocations"]; !heap.is_null()) {
    EXPECT_EQ(heap, 0);  // builds with sanitizers cannot count
  }

  // python-can reads the log, and its player plays it.
  const std::string python = ARMADA_PYTHON;
  const auto frames = OutputLines(python + " " + ARMADA_CAN_LOG_JUDGE + " " + Out("can_4.log"));
  EXPECT_EQ(frames.size(), arm["can_log"]["frames"].get<size_t>());
  const auto are = [&](const std::string& what) {
    return std::count_if(frames.begin(), frames.end(),
                         [&](const std::string& frame) { return frame.find(what) != std::string::npos; });
  };
  EXPECT_GT(are(" can4 29 r 8 -"), 0);                 // what the board asked
  EXPECT_GT(are(" can4 29 - 8 "), 0);                  // what the drive answered
  EXPECT_GT(are(" can4 2E - 4 0000f041"), 0);          // 30 N m
  EXPECT_GT(are(" can4 21 - 8 0000000008010000"), 0);  // heartbeat in closed loop
  const auto played = OutputLines(python + " -m can.player -i virtual -c test --ignore-timestamps -g 0 -v " +
                                  Out("can_4.log") + " | grep -c '^Timestamp'");
  ASSERT_EQ(played.size(), 1u);
  EXPECT_EQ(std::stoul(played[0]), frames.size());
}

TEST_F(HilProcessTest, EndsByItselfAfterItsSeconds) {
  Start("hil", {Scenario(), "--seconds", "0.25", "--seed", "7", "--out", Out()});
  EXPECT_EQ(ExitCode(), kExitOk) << Said("hil");
  const nlohmann::json report = Report();
  EXPECT_EQ(report["end"], "done");
  EXPECT_EQ(report["seconds"], 0.25);
  EXPECT_EQ(report["seed"], 7);
  EXPECT_EQ(report["arms"].at(0)["samples"], 250);
  EXPECT_TRUE(report["arms"].at(0)["released_s"].is_null());
}

TEST_F(HilProcessTest, HasFaultsOfDrivesAndBusesAndSaysWhatItLeavesOut) {
  const std::string of_drive = R"({kind="drive",at_s=0.1,arm=4,signal="status",way="off"})";
  const std::string of_leader = R"({kind="leader_dies",at_s=0.1})";
  const std::string of_link = R"({kind="link_loss",arm=4,at_s=0.2,value=0.5})";
  Start("hil", {Scenario(), "--seconds", "0.25", "--out", Out(), "--set",
                "fault=[" + of_drive + "," + of_leader + "," + of_link + "]"});
  EXPECT_EQ(ExitCode(), kExitOk) << Said("hil");
  EXPECT_NE(Said("hil").find("fault link_loss at 0.2 s is left out"), std::string::npos) << Said("hil");
  EXPECT_EQ(Said("hil").find("fault drive"), std::string::npos) << Said("hil");
  EXPECT_EQ(Said("hil").find("fault leader_dies"), std::string::npos) << "armada run makes it";
}

TEST_F(HilProcessTest, StandsReadyBeforeTheGivenEpoch) {
  const int64_t epoch_ns = MonotonicNow() + 1'000'000'000'000;
  Start("hil", {Scenario(), "--epoch-ns", std::to_string(epoch_ns), "--out", Out()});
  ASSERT_TRUE(Board().UntilHeard()) << Said("hil");
  const std::vector<ProcessExit> exits = group_.StopAll(kPatience);
  ASSERT_EQ(exits.size(), 1u);
  EXPECT_EQ(exits[0].Code(), kExitInterrupted) << exits[0].Describe();
  const nlohmann::json report = Report();
  EXPECT_EQ(report["epoch_ns"], epoch_ns);
  EXPECT_EQ(report["seconds"], 0.0);
  EXPECT_TRUE(report["arms"].at(0)["rms_mm"].is_null());
}

TEST_F(HilProcessTest, RefusesABusOnWhichADriveIsActive) {
  Start("first", {Scenario()});
  ASSERT_TRUE(Board().UntilHeard()) << Said("first");
  Start("second", {Scenario(), "--out", Out()});
  EXPECT_EQ(ExitCode(), kExitFailed);
  EXPECT_EQ(Said("second"), std::string("armada-hil: bus ") + kBus +
                                ": another emulation or drive is already active (frames of node 1)\n");
  EXPECT_FALSE(std::filesystem::exists(Out()));
  EXPECT_TRUE(Board().UntilHeard()) << "the first goes on";
}

TEST_F(HilProcessTest, NeedsARouteForMulticast) {
  std::string error;
  ASSERT_TRUE(group_.Start({.name = "hil",
                            .argv = {"/usr/bin/unshare", "-n", ARMADA_HIL, Scenario()},
                            .environment = {},
                            .log_path = folder_ / "hil.log"},
                           &error))
      << error;
  EXPECT_EQ(ExitCode(), kExitFailed);
  EXPECT_NE(Said("hil").find("There is no route for multicast"), std::string::npos) << Said("hil");
}

TEST_F(HilProcessTest, ListsWhatIsWrongWithItsConfiguration) {
  Start("hil", {Scenario(), "--set", "drive.latency_s=7", "--set", "arm.4.bus=can0"});
  EXPECT_EQ(ExitCode(), kExitBadConfig);
  EXPECT_NE(Said("hil").find("--set: drive.latency_s: given 7"), std::string::npos) << Said("hil");
  EXPECT_NE(Said("hil").find("--set: arm.4.bus: "), std::string::npos) << Said("hil");
}

TEST_F(HilProcessTest, RefusesAnEpochThatIsPastOrOfAnotherClock) {
  for (const char* epoch_ns : {"1", "1795304642124045000"}) {
    Start(epoch_ns, {Scenario(), "--epoch-ns", epoch_ns});
    EXPECT_EQ(ExitCode(), kExitUsage);
    EXPECT_NE(Said(epoch_ns).find(std::string("--epoch-ns ") + epoch_ns + ": must be on CLOCK_MONOTONIC"),
              std::string::npos)
        << Said(epoch_ns);
  }
}

TEST_F(HilProcessTest, NeedsAScenarioAndAWritableDirectory) {
  Start("usage", {"--seed", "-1"});
  EXPECT_EQ(ExitCode(), kExitUsage);
  Start("directory", {Scenario(), "--out", Scenario() + "/out"});
  EXPECT_EQ(ExitCode(), kExitFailed);
  EXPECT_NE(Said("directory").find("cannot make " + Scenario() + "/out: "), std::string::npos)
      << Said("directory");
}

}  // namespace
}  // namespace armada
