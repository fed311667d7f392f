#include "host/run/process_faults.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>

#include "firmware/clock/machine_clock.h"
#include "tests/support/numbers.h"

namespace armada {
namespace {

using std::chrono::milliseconds;

constexpr double kLate_s = 0.05;  // on a busy machine without the right to real-time priority

FaultConfig Fault(FaultKind kind, double at_s, double until_s = FaultConfig::kForGood_s) {
  return {.kind = kind, .at_s = at_s, .until_s = until_s, .arm = 3};
}

/// Programs in the place of controllers, for 0.3 s.
class ProcessFaultsTest : public testing::Test {
 protected:
  static constexpr double kEnd_s = 0.3;

  ProcessFaultsTest() { Start("arm 3"); }

  void Start(const std::string& name) {
    EXPECT_TRUE(group_.Start({name, {"/bin/sleep", "1000"}, {}, "/dev/null"}, &error_)) << error_;
  }

  /// Those that have ended until the run's end.
  std::vector<ProcessExit> Run(const std::vector<FaultConfig>& faults) {
    Clock* const clock = MachineClock::Get();
    epoch_ns_ = clock->Now() + 30 * kMs;
    const int64_t end_ns = epoch_ns_ + static_cast<int64_t>(kEnd_s * 1e9);
    faults_.emplace(faults, std::map<int, std::string>{}, clock, epoch_ns_, end_ns);
    std::vector<ProcessExit> ended;
    while (clock->Now() < end_ns) {
      const int64_t left_ns = std::clamp<int64_t>(faults_->Next() - clock->Now(), 0, 5 * kMs);
      if (auto one = group_.Poll(std::chrono::nanoseconds(left_ns))) ended.push_back(*one);
      EXPECT_TRUE(faults_->MakeDue(
          &control_,
          [&](int arm_id, std::string*) {
            Start(ProcessFaults::ArmProcess(arm_id));
            return true;
          },
          &error_));
    }
    return ended;
  }

  void ExpectMade(const std::vector<std::pair<std::string, double>>& wanted) const {
    ASSERT_EQ(faults_->made().size(), wanted.size());
    for (size_t i = 0; i < wanted.size(); ++i) {
      const ProcessFaults::Made& made = faults_->made()[i];
      EXPECT_EQ(made.what, wanted[i].first);
      EXPECT_NEAR(made.at_s, wanted[i].second, 1e-8);
      EXPECT_GE(made.made_s, made.at_s);
      EXPECT_LT(made.made_s, made.at_s + kLate_s);
    }
  }

  std::string error_;
  ProcessGroup group_;
  SignalControl control_{&group_};
  int64_t epoch_ns_ = 0;
  std::optional<ProcessFaults> faults_;
};

TEST_F(ProcessFaultsTest, AControllerIsKilledAtItsTimeAndThatIsNoFailure) {
  const auto ended = Run({Fault(FaultKind::kControllerDies, 0.123456789)});
  ExpectMade({{"killed", 0.123456789}});
  ASSERT_EQ(ended.size(), 1u);
  EXPECT_EQ(WTERMSIG(ended[0].wait_status), SIGKILL);
  EXPECT_TRUE(faults_->TakeOrdered(ended[0]));
  EXPECT_FALSE(faults_->TakeOrdered(ended[0])) << "one death was ordered, not two";
  EXPECT_EQ(faults_->dead_arms(), std::set<int>{3});
}

TEST_F(ProcessFaultsTest, ADeathThatNobodyOrderedIsAFailure) {
  group_.Signal("arm 3", SIGSEGV);
  const auto ended = Run({Fault(FaultKind::kControllerStops, 0.2, 0.25)});
  ASSERT_EQ(ended.size(), 1u);
  EXPECT_FALSE(faults_->TakeOrdered(ended[0]));
  EXPECT_TRUE(faults_->dead_arms().empty());
}

TEST_F(ProcessFaultsTest, AStoppedControllerGoesOnAtItsTime) {
  EXPECT_TRUE(Run({Fault(FaultKind::kControllerStops, 0.1, 0.15)}).empty());
  ExpectMade({{"stopped", 0.1}, {"continued", 0.15}});
  EXPECT_EQ(faults_->stopped_for_good(), 0u);
  EXPECT_TRUE(group_.Signal("arm 3", SIGTERM));
  EXPECT_TRUE(group_.Poll(milliseconds(20000)).has_value()) << "it is still stopped";
}

TEST_F(ProcessFaultsTest, AControllerThatIsStoppedBeyondTheEndIsKilledThereWithoutGoingOn) {
  EXPECT_TRUE(Run({Fault(FaultKind::kControllerStops, 0.1, kEnd_s + 1.0)}).empty());
  EXPECT_EQ(faults_->stopped_for_good(), 1u);
  faults_->KillStopped(&control_);
  EXPECT_EQ(faults_->stopped_for_good(), 0u);
  const auto ended = group_.Poll(milliseconds(20000));
  ASSERT_TRUE(ended.has_value());
  EXPECT_EQ(WTERMSIG(ended->wait_status), SIGKILL);
  EXPECT_TRUE(faults_->TakeOrdered(*ended));
}

TEST_F(ProcessFaultsTest, AControllerIsStartedAnewAndMayDieAgain) {
  const auto ended =
      Run({Fault(FaultKind::kControllerRestarts, 0.05, 0.1), Fault(FaultKind::kControllerDies, 0.15)});
  ExpectMade({{"killed", 0.05}, {"started", 0.1}, {"killed", 0.15}});
  ASSERT_EQ(ended.size(), 2u);
  EXPECT_NE(ended[0].pid, ended[1].pid);
  EXPECT_TRUE(faults_->TakeOrdered(ended[0]) && faults_->TakeOrdered(ended[1]));
}

TEST_F(ProcessFaultsTest, AHogTakesAProcessorForItsTime) {
  timespec before{};
  timespec after{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &before);
  FaultConfig hog = Fault(FaultKind::kCpuHog, 0.05, 0.25);
  hog.value = 1;  // before the other programs of a busy machine, with the right to it
  Run({hog});
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &after);
  const double taken_s = static_cast<double>(after.tv_sec - before.tv_sec) +
                         1e-9 * static_cast<double>(after.tv_nsec - before.tv_nsec);
  EXPECT_GT(taken_s, 0.02);
  EXPECT_LT(taken_s, 0.25);
}

TEST_F(ProcessFaultsTest, ALinkThatIsNotTheBoardsAloneStaysUp) {
  Run({Fault(FaultKind::kBusDown, 0.05)});
  ExpectMade({});
}

}  // namespace
}  // namespace armada
