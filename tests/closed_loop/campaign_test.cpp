// The campaign of random faults: that its trials are legal, that its judge finds what is wrong, and that what
// it finds is made small.

#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>

#include "firmware/app/heap_counter.h"
#include "host/campaign/campaign.h"
#include "host/campaign/isolated.h"
#include "host/campaign/judge.h"
#include "host/campaign/shrink.h"
#include "host/campaign/trial.h"
#include "host/campaign/trial_script.h"
#include "tests/closed_loop/simulate.h"
#include "tests/support/temp_dir.h"

namespace armada {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::Field;
using testing::IsEmpty;
using testing::Not;

auto Breaks(Invariant invariant) {
  return Field("invariant", &Violation::invariant, invariant);
}

std::optional<ScenarioConfig> Reload(const ScenarioConfig& trial, const TempDir& folder) {
  const std::string path = (folder.path() / "trial.toml").string();
  std::ofstream(path) << ScriptOf(trial, "trial", folder.path().string(), "# a trial");
  std::vector<ConfigError> errors;
  auto reloaded = LoadScenario(path, {}, &errors);
  for (const ConfigError& error : errors) ADD_FAILURE() << ToString(error);
  return reloaded;
}

TEST(Trial, IsALegalScriptThatSaysAllOfIt) {
  const TempDir folder;
  const ScenarioConfig base = ScenarioNamed("campaign");
  for (uint64_t seed = 1; seed <= 300; ++seed) {
    const ScenarioConfig trial = DrawTrial(base, seed);
    const auto reloaded = Reload(trial, folder);
    ASSERT_TRUE(reloaded) << "seed " << seed;
    EXPECT_EQ(ScriptOf(*reloaded, "trial", "/", ""), ScriptOf(
                                                         [&] {
                                                           ScenarioConfig same = trial;
                                                           same.file = reloaded->file;
                                                           return same;
                                                         }(),
                                                         "trial", "/", ""))
        << "seed " << seed;
    EXPECT_LE(trial.faults.size(), 2u);
  }
}

TEST(Trial, LeavesNoKindOfFaultNoSignalAndNoWayOut) {
  const ScenarioConfig base = ScenarioNamed("campaign");
  Coverage coverage;
  for (uint64_t seed = 1; seed <= 1000; ++seed) coverage.Add(DrawTrial(base, seed), {});
  EXPECT_EQ(coverage.cells_tried(), coverage.cells());
}

TEST(Trial, OfTheSameSeedIsJudgedTheSame) {
  const ScenarioConfig base = ScenarioNamed("campaign", {"seconds=9.0"});
  const ScenarioConfig trial = DrawTrial(base, 25);
  EXPECT_EQ(ToText(RunTrial(trial, 25)), ToText(RunTrial(trial, 25)));
}

TEST(Judge, HasNothingToSayOfAFleetWithoutFaults) {
  EXPECT_THAT(RunTrial(ScenarioNamed("campaign"), 1).violations, IsEmpty());
}

// With its watch on positions put to sleep a board believes whatever a drive says.
TEST(Judge, FindsAnArmThatIsDrivenAboutByALyingSensor) {
  const ScenarioConfig trial = ScenarioNamed(
      "campaign", {"fault=[{kind=\"drive\",at_s=4.0,arm=2,joint=1,signal=\"position\",way=\"stuck\"}]",
                   "control.sensor.consistent_travel_rad=10.0", "control.sensor.frozen_travel_rad=10.0",
                   "control.sensor.frozen_pushed_s=100.0", "control.supervisor.saturated_max_s=100.0",
                   "control.supervisor.hold_drift_rad=100.0", "control.supervisor.sigma_min=0.0"});
  EXPECT_THAT(RunTrial(trial, 1).violations,
              Contains(AllOf(Breaks(Invariant::kNoWildMotion), Field("arm", &Violation::arm, 2))));
}

TEST(Judge, FindsArmsThatFollowALeaderThatIsDead) {
  const ScenarioConfig trial = ScenarioNamed(
      "campaign",
      {"fault=[{kind=\"leader_dies\",at_s=4.0}]", "link.silence.messages=40", "estimator.age_max_s=0.45"});
  EXPECT_THAT(RunTrial(trial, 1).violations, Each(Breaks(Invariant::kHoldsInTime)));
  EXPECT_THAT(RunTrial(trial, 1).violations, Not(IsEmpty()));
}

TEST(Judge, FindsAnArmThatAFaultOfAnotherTakesAlong) {
  const ScenarioConfig trial = ScenarioNamed(
      "campaign", {"fault=[{kind=\"leader_jumps\",at_s=4.0,value=0.5}]", "link.plausible_step=1e6"});
  ScenarioConfig told = trial;
  told.faults[0].at_s = 8.9;  // the judge is told of it only later
  Judge judge(told);
  Simulation(trial, 1, &judge).Run(nullptr);
  EXPECT_THAT(judge.violations(), IsEmpty()) << "the leader is touched in this trial";
  told.faults.clear();
  Judge unaware(told);
  Simulation(trial, 1, &unaware).Run(nullptr);
  EXPECT_THAT(unaware.violations(), Contains(Breaks(Invariant::kOthersTrack)));
}

// A watchdog that is slower than the fleet file says: the bring-up would not notice before it trips.
TEST(Judge, FindsADriveThatDrivesOnWithoutCommands) {
  const ScenarioConfig trial =
      ScenarioNamed("campaign", {"fault=[{kind=\"controller_dies\",at_s=4.0,arm=2}]"});
  EXPECT_THAT(RunTrial(trial, 1).violations, IsEmpty());
  ScenarioConfig promised = trial;
  for (JointDriveConfig& joint : promised.fleet.arms[1].joints) joint.watchdog_s = 0.005;
  Judge judge(promised);
  Simulation(trial, 1, &judge).Run(nullptr);
  EXPECT_THAT(judge.violations(),
              Contains(AllOf(Breaks(Invariant::kDriveStops), Field("arm", &Violation::arm, 2))));
}

CanFrame TorqueFrame(float torque_Nm) {
  CanFrame frame;
  frame.id = 1u << 5 | 0x0E;
  frame.length = 8;
  const auto bits = std::bit_cast<uint32_t>(torque_Nm);
  for (size_t i = 0; i < 4; ++i) frame.data[i] = static_cast<uint8_t>(bits >> 8 * i);
  return frame;
}

TEST(Judge, FindsTorquesBeyondLimitsAndThoseThatAreNoNumbers) {
  const ScenarioConfig trial = ScenarioNamed("campaign");
  Judge judge(trial);
  judge.OnFrame(0, 1.0, TorqueFrame(150.0f));
  judge.OnFrame(0, 1.0, TorqueFrame(-150.0f));
  EXPECT_THAT(judge.violations(), IsEmpty());
  judge.OnFrame(0, 1.0, TorqueFrame(150.1f));
  judge.OnFrame(0, 1.0, TorqueFrame(NAN));
  judge.OnFrame(0, 1.0, TorqueFrame(-INFINITY));
  EXPECT_EQ(judge.violations().size(), 3u);
  EXPECT_THAT(judge.violations(), Each(Breaks(Invariant::kTorqueInLimits)));
}

/// What the judge says of these states, told by arm 1 one second after the other.
Violations Told(const ScenarioConfig& trial, const std::vector<int>& states) {
  Judge judge(trial);
  double t_s = 0.0;
  for (const int state : states) {
    estimate_t message{};
    message.state = static_cast<int8_t>(state);
    MessageBuffer buffer;
    judge.OnEstimate(0, t_s, Encode(message, &buffer));
    t_s += 1.0;
  }
  return judge.violations();
}

TEST(Judge, FindsArmsThatMoveWithoutAnOperator) {
  enum { kInit, kMonitor, kArming, kRun, kDegraded, kHold, kSafeStop, kFault };
  const ScenarioConfig running = ScenarioNamed("campaign");
  EXPECT_THAT(Told(running, {kRun, kDegraded, kRun, kHold, kSafeStop, kFault}), IsEmpty());
  EXPECT_THAT(Told(running, {kRun, kHold, kRun}), Contains(Breaks(Invariant::kNothingRearms)));
  EXPECT_THAT(Told(running, {kRun, kFault, kHold}), Contains(Breaks(Invariant::kNothingRearms)));
  EXPECT_THAT(Told(running, {kRun, kInit, kMonitor, kArming}), Contains(Breaks(Invariant::kNothingRearms)));
  ScenarioConfig operated = ScenarioNamed("campaign", {"start.mode=monitor"});
  EXPECT_THAT(Told(operated, {kMonitor, kArming}), Contains(Breaks(Invariant::kNothingRearms)));
  operated.operations = {{1.0, 1, Request::kArm}, {3.0, 0, Request::kStart}};
  EXPECT_THAT(Told(operated, {kMonitor, kArming, kHold, kRun, kHold}), IsEmpty());
  EXPECT_THAT(Told(operated, {kMonitor, kArming, kHold, kHold, kHold, kRun}),
              Contains(Breaks(Invariant::kNothingRearms)))
      << "the request was long ago";
}

TEST(Judge, CountsWhatABoardAllocates) {
  if (!HeapCounter::available()) GTEST_SKIP() << "nothing is counted in this build";
  const size_t size = ScenarioNamed("campaign").fleet.arms.size();
  Judge judge(ScenarioNamed("campaign"));
  judge.Enter(2);
  const std::vector<int> allocated(size);
  judge.Leave(2);
  EXPECT_EQ(allocated.size(), size);
  EXPECT_THAT(judge.violations(),
              Contains(AllOf(Breaks(Invariant::kNoHeap), Field("arm", &Violation::arm, 3))));
}

TEST(Isolated, DoesAllPiecesAndSurvivesThoseThatCrash) {
  std::map<size_t, IsolatedResult> results;
  RunIsolated(
      9, 3,
      [](size_t piece) {
        if (piece == 4) std::abort();
        return std::string(piece * 50'000, 'x');  // more than a pipe holds
      },
      [&](size_t piece, const IsolatedResult& result) { results[piece] = result; });
  ASSERT_EQ(results.size(), 9u);
  for (const auto& [piece, result] : results) {
    EXPECT_EQ(result.output.size(), piece == 4 ? 0 : piece * 50'000) << piece;
    EXPECT_EQ(result.crash.empty(), piece != 4) << result.crash;
  }
}

TEST(Shrink, LeavesOnlyWhatItTakes) {
  const ScenarioConfig base = ScenarioNamed("campaign");
  ScenarioConfig trial = DrawTrial(base, 3);
  trial.faults = {{.kind = FaultKind::kBusOff, .at_s = 4.123456, .until_s = 4.9, .arm = 3},
                  {.kind = FaultKind::kBusLoss, .at_s = 5.4321, .arm = 2, .value = 0.123456}};
  trial.operations = {{1.0, 2, Request::kHold}};
  trial.start.mode = StartMode::kMonitor;
  const ScenarioConfig smallest = Shrink(trial, [](const ScenarioConfig& simpler) {
    return std::any_of(simpler.faults.begin(), simpler.faults.end(), [](const FaultConfig& fault) {
      return fault.kind == FaultKind::kBusLoss && fault.value > 0.11 && fault.at_s > 5.02;
    });
  });
  ASSERT_EQ(smallest.faults.size(), 1u);
  EXPECT_EQ(smallest.faults[0].kind, FaultKind::kBusLoss);
  EXPECT_EQ(smallest.faults[0].at_s, 5.4);
  EXPECT_EQ(smallest.faults[0].value, 0.12);
  EXPECT_THAT(smallest.operations, IsEmpty());
  EXPECT_EQ(smallest.start.mode, StartMode::kRunning);
}

// The campaign itself, in short.
TEST(Campaign, FindsNoViolation) {
  const TempDir folder;
  const CampaignOptions options{.trials = 60, .directory = folder.path().string()};
  const CampaignResult result = RunCampaign(ScenarioNamed("campaign"), options, [](size_t, size_t) {});
  for (const FailedTrial& failed : result.failed) {
    ADD_FAILURE() << "seed " << failed.seed << ": " << TextOf(failed.violation.invariant) << ", arm "
                  << failed.violation.arm << " at " << failed.violation.t_s
                  << " s: " << failed.violation.what;
  }
}

TEST(Campaign, WritesAScriptThatFailsAgain) {
  const TempDir folder;
  const ScenarioConfig base =
      ScenarioNamed("campaign", {"link.silence.messages=40", "estimator.age_max_s=0.45"});
  const CampaignOptions options{.first_seed = 1, .trials = 40, .directory = folder.path().string()};
  const CampaignResult result = RunCampaign(base, options, [](size_t, size_t) {});
  ASSERT_THAT(result.failed, Not(IsEmpty()));
  std::vector<ConfigError> errors;
  const auto script = LoadScenario(result.failed.front().script,
                                   {"link.silence.messages=40", "estimator.age_max_s=0.45"}, &errors);
  ASSERT_TRUE(script);
  EXPECT_EQ(script->faults.size(), 1u);
  EXPECT_THAT(RunTrial(*script, result.failed.front().seed).violations,
              Contains(Breaks(result.failed.front().violation.invariant)));
}

}  // namespace
}  // namespace armada
