#include "host/run/run_diagnosis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <sstream>

#include "firmware/core/cause.h"
#include "firmware/link/channels.h"

namespace armada {
namespace {

using testing::HasSubstr;

constexpr int64_t kEpoch_ns = 1'000'000'000'000;
constexpr double kSeconds = 10.0;

int64_t At(double t_s) {
  return kEpoch_ns + static_cast<int64_t>(t_s * 1e9);
}

Stall StallAt(double t_s, double length_s) {
  return {At(t_s), At(t_s + length_s), 1, 0};
}

/// A run of two arms in which everything is in time and within the criterion; each test spoils something.
class DiagnosisTest : public testing::Test {
 protected:
  DiagnosisTest() {
    scenario_.file = "some.toml";
    scenario_.seconds = kSeconds;
    scenario_.window_start_s = 5.0;
    for (const int id : {3, 7}) {
      scenario_.fleet.arms.emplace_back().id = id;
      ArmMetrics& arm = metrics_.arms.emplace_back();
      arm.id = id;
      arm.max_m = 0.001;
      arm.state = "RUN";
      std::vector<telemetry_t>& ticks = ticks_.emplace_back();
      for (int k = 0; k < 1000; ++k) {
        telemetry_t& tick = ticks.emplace_back();
        tick.sequence = k + 1;
        tick.stamp_ns = At(0.01 * k);
        tick.state = static_cast<int8_t>(ControllerState::kRun);
        tick.cause = static_cast<int8_t>(Cause::kNone);
      }
    }
    evidence_.scenario = &scenario_;
    evidence_.seed = 4;
    evidence_.epoch_ns = kEpoch_ns;
    evidence_.processors = 2;
  }

  std::vector<telemetry_t>& TicksOf(int id) { return ticks_[id == 3 ? 0 : 1]; }
  ArmMetrics& MetricsOf(int id) { return metrics_.arms[id == 3 ? 0 : 1]; }

  /// From that tick on.
  void Stop(int id, int tick, ControllerState state, Cause cause) {
    for (size_t k = static_cast<size_t>(tick); k < 1000; ++k) {
      TicksOf(id)[k].state = static_cast<int8_t>(state);
      TicksOf(id)[k].cause = static_cast<int8_t>(cause);
    }
    MetricsOf(id).state = NameOf(state);
    MetricsOf(id).faults = {NameOf(cause)};
  }
  /// Ticks that were missed before this one.
  void Miss(int id, int tick, int count) {
    TicksOf(id).erase(TicksOf(id).begin() + tick - count, TicksOf(id).begin() + tick);
    for (size_t k = static_cast<size_t>(tick - count); k < TicksOf(id).size(); ++k) {
      TicksOf(id)[k].missed_ticks = count;
      TicksOf(id)[k].sequence -= count;
    }
  }

  std::vector<RunFinding> Result() {
    metrics_.Judge(scenario_.criterion);
    evidence_.metrics = evidence_.broke_off.empty() ? &metrics_ : nullptr;
    evidence_.arms.clear();
    for (size_t i = 0; i < ticks_.size(); ++i) evidence_.arms.push_back({ticks_[i], boards_[i], benches_[i]});
    return Diagnose(evidence_);
  }

  ScenarioConfig scenario_;
  RunMetrics metrics_;
  std::vector<std::vector<telemetry_t>> ticks_;
  std::array<Json, 2> boards_, benches_;
  RunEvidence evidence_;
};

TEST_F(DiagnosisTest, OfARunThatIsOkThereIsNothingToSay) {
  EXPECT_TRUE(Result().empty());
  EXPECT_TRUE(metrics_.ok);
}

TEST_F(DiagnosisTest, AStallIsNamedThenTheArmsItStopped) {
  evidence_.stalls = {{At(5.204), At(5.516), 2, 0}};
  for (const int id : {3, 7}) Miss(id, 552, 31);
  Stop(7, 552 - 31, ControllerState::kFault, Cause::kFeedbackStale);
  ticks_[1].resize(1000 - 31);
  const auto findings = Result();
  ASSERT_EQ(findings.size(), 2u);
  EXPECT_EQ(findings[0].kind, "stall");
  EXPECT_EQ(findings[0].text,
            "the machine stood still (or every program of the run was stopped) for 0.312 s at 5.204 s");
  EXPECT_EQ(findings[1].kind, "stopped");
  EXPECT_EQ(findings[1].arm_id, 7);
  EXPECT_NEAR(*findings[1].at_s, 5.52, 1e-9);
  EXPECT_EQ(findings[1].text, "arm 7 went to FAULT at 5.520 s (feedback stale); 31 ticks missed at 5.520 s");
}

TEST_F(DiagnosisTest, AStallThroughWhichBoardsTickedIsNotOfTheMachine) {
  evidence_.stalls = {{At(5.204), At(5.516), 2, 0}};
  const auto findings = Result();
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].text, "`armada run` stood still, while boards went on, for 0.312 s at 5.204 s");
}

TEST_F(DiagnosisTest, BoardsThatWakeALittleBeforeTheHeartbeatDidNotGoOn) {
  evidence_.stalls = {{At(5.204), At(5.516), 2, 0}};
  for (const int id : {3, 7}) Miss(id, 545, 24);  // 5.21 to 5.44 s
  EXPECT_THAT(Result()[0].text, HasSubstr("the machine stood still"));
}

TEST_F(DiagnosisTest, AStallInWhichMessagesOfBoardsWereLostIsNotOfTheMachine) {
  evidence_.stalls = {{At(5.204), At(5.716), 2, 0}};
  for (const int id : {3, 7}) TicksOf(id).erase(TicksOf(id).begin() + 540, TicksOf(id).begin() + 575);
  EXPECT_THAT(Result()[0].text, HasSubstr("`armada run` stood still, while boards went on"));
}

TEST_F(DiagnosisTest, ABoardThatWasStartedAnewInAStallDoesNotTellThatItWentOn) {
  evidence_.stalls = {{At(5.204), At(5.716), 2, 0}};
  for (const int id : {3, 7}) {
    TicksOf(id).erase(TicksOf(id).begin() + 521, TicksOf(id).begin() + 571);
    for (size_t k = 521; k < TicksOf(id).size(); ++k) TicksOf(id)[k].sequence -= 570;
  }
  EXPECT_THAT(Result()[0].text, HasSubstr("the machine stood still"));
}

TEST_F(DiagnosisTest, AStallOfOneProcessorAndAHeartbeatWithoutPriorityAreCalledSo) {
  evidence_.stalls = {{At(-0.3), At(-0.25), 1, 1}};
  evidence_.heartbeat_is_foremost = false;
  const auto findings = Result();
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(
      findings[0].text,
      "processor 1 of the machine stood still for 0.050 s at 0.300 s before the start; the heartbeat had "
      "no priority: it may have been load");
}

TEST_F(DiagnosisTest, OfManyStallsTheLongestAreListed) {
  Stop(3, 900, ControllerState::kHold, Cause::kTicksMissed);
  for (int i = 0; i < 10; ++i) {
    const double at_s = 8.2 + 0.05 * i;
    evidence_.stalls.push_back({At(at_s), At(at_s + 0.001 * (i + 1)), 1, 0});
  }
  const auto findings = Result();
  ASSERT_EQ(findings.size(), 5u);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(*findings[i].at_s, 8.55 + 0.05 * static_cast<double>(i), 1e-6) << "in the order of time";
  }
  EXPECT_EQ(findings[3].text, "7 further stalls of at most 0.007 s");
  EXPECT_EQ(findings[4].arm_id, 3);
}

TEST_F(DiagnosisTest, AStallOfLongBeforeIsNoCause) {
  Stop(3, 900, ControllerState::kHold, Cause::kSingular);
  evidence_.stalls = {{At(1.0), At(1.02), 1, 0}};
  const auto findings = Result();
  ASSERT_EQ(findings.size(), 3u);
  EXPECT_EQ(findings[0].kind, "stopped");
  EXPECT_EQ(findings[1].kind, "none");
  EXPECT_EQ(findings[2].kind, "stall");
}

TEST_F(DiagnosisTest, AStallBeforeTheFirstFailureIsTheCauseWhateverLongerOnesThereAre) {
  Stop(3, 600, ControllerState::kHold, Cause::kTicksMissed);
  Stop(7, 900, ControllerState::kHold, Cause::kTicksMissed);
  evidence_.stalls = {StallAt(5.7, 0.01), StallAt(6.5, 0.3),  StallAt(7.0, 0.3),  StallAt(7.5, 0.3),
                      StallAt(8.2, 0.04), StallAt(8.4, 0.04), StallAt(8.6, 0.04), StallAt(8.8, 0.03)};
  const auto findings = Result();
  ASSERT_EQ(findings.size(), 9u);
  EXPECT_NEAR(*findings[0].at_s, 5.7, 1e-6);
  EXPECT_NEAR(*findings[1].at_s, 8.2, 1e-6) << "of the later failure";
  EXPECT_EQ(findings[4].text, "1 further stall of at most 0.030 s");
  EXPECT_EQ(findings[5].arm_id, 3);
  EXPECT_EQ(findings[6].arm_id, 7);
  EXPECT_NEAR(*findings[7].at_s, 6.5, 1e-6) << "of no failure";
  EXPECT_EQ(findings[8].text, "2 further stalls of at most 0.300 s");
}

TEST_F(DiagnosisTest, AFailureWithoutATimeIsOfTheWholeWindow) {
  Stop(3, 800, ControllerState::kHold, Cause::kTicksMissed);
  scenario_.criterion.standing = {7};
  MetricsOf(7).joint_speed_max_rad_s = 2.0;
  TicksOf(7)[550].wakeup_lateness_us = 9900;
  evidence_.stalls = {StallAt(2.0, 0.3), StallAt(5.5, 0.2), StallAt(7.9, 0.01), StallAt(9.0, 0.2)};
  const auto findings = Result();
  ASSERT_EQ(findings.size(), 6u);
  EXPECT_NEAR(*findings[0].at_s, 7.9, 1e-6) << "before the first failure";
  EXPECT_NEAR(*findings[1].at_s, 5.5, 1e-6) << "in the window";
  EXPECT_NEAR(*findings[2].at_s, 9.0, 1e-6);
  EXPECT_EQ(findings[3].arm_id, 3);
  EXPECT_EQ(findings[4].kind, "moved");
  EXPECT_FALSE(findings[4].at_s);
  EXPECT_THAT(findings[4].text, HasSubstr("; woken 9.9 ms late at 5.500 s"));
  EXPECT_NEAR(*findings[5].at_s, 2.0, 1e-6) << "long before the window";
}

TEST_F(DiagnosisTest, OfAFleetThatMissesTheCriterionEveryBoardIsExamined) {
  scenario_.criterion.fleet_rms_max_m = 0.001;
  MetricsOf(3).rms_m = 0.001;
  MetricsOf(7).rms_m = 0.002;
  Miss(3, 432, 2);
  TicksOf(7)[100].wakeup_lateness_us = 9900;
  boards_[0] = {{"timing", {{"missed_ticks", 2}, {"incomplete_samples", 0}, {"unsent_ticks", 0}}},
                {"bus",
                 {{"can_dropped", 0},
                  {"can_dropped_late", 0},
                  {"can_receive_overflowed", 0},
                  {"can_errors", 0},
                  {"lcm_overflowed", 0},
                  {"lcm_rejected", 0},
                  {"lcm_heard", Json::array()}}}};
  boards_[0]["timing"]["realtime_priority"] = true;
  const auto findings = Result();
  ASSERT_EQ(findings.size(), 4u);
  EXPECT_EQ(findings[0].text,
            "fleet RMS 1.581 mm, criterion.fleet_rms_max_m is 1.000 mm; arm 7 has the largest, 2.000 mm");
  EXPECT_EQ(findings[1].kind, "late");
  EXPECT_EQ(findings[1].arm_id, 3);
  EXPECT_EQ(findings[1].text, "arm 3: 2 ticks missed at 4.320 s");
  EXPECT_EQ(findings[2].text, "arm 7: before: woken 9.9 ms late at 1.000 s");
  EXPECT_EQ(findings[3].text, "arm 3 in the whole run: missed ticks 2");
}

TEST_F(DiagnosisTest, WhereTheFleetMissesTheCriterionAndNoBoardWasLateItIsTheController) {
  scenario_.criterion.fleet_rms_max_m = 0.001;
  MetricsOf(7).rms_m = 0.002;
  for (const int id : {3, 7}) TicksOf(id).erase(TicksOf(id).begin() + 540, TicksOf(id).begin() + 575);
  benches_[0] = {{"drives", {{{"off_s", 9.99}}}}};
  const auto findings = Result();
  ASSERT_EQ(findings.size(), 2u) << "neither messages lost on the way here nor rest at the end are lateness";
  EXPECT_EQ(findings[0].kind, "fleet_rms");
  EXPECT_EQ(findings[1].kind, "none");
}

TEST_F(DiagnosisTest, AnArmThatFailedInTimeIsExaminedOverTheWholeWindowWhereTheFleetMissesToo) {
  scenario_.criterion.kind = CriterionKind::kAgreement;
  metrics_.estimate_spread_m = 0.1;
  MetricsOf(3).max_m = 0.0352;
  MetricsOf(3).beyond_at_s = 6.0;
  Miss(3, 900, 2);
  const auto findings = Result();
  ASSERT_EQ(findings.size(), 3u);
  EXPECT_THAT(findings[0].text, HasSubstr("nothing was late or lost on its board before"));
  EXPECT_EQ(findings[1].kind, "agreement");
  EXPECT_EQ(findings[2].text, "arm 3: 2 ticks missed at 9.000 s");
}

TEST_F(DiagnosisTest, AnErrorNamesTheCriterionTheTimeAndWhatWasLateThen) {
  MetricsOf(3).max_m = 0.0352;
  MetricsOf(3).max_at_s = 6.13;
  MetricsOf(3).beyond_at_s = 6.0;
  TicksOf(3)[590].wakeup_lateness_us = 8200;
  TicksOf(3)[100].wakeup_lateness_us = 9900;  // long before
  TicksOf(3)[595].sample_to_torque_us = 4400;
  benches_[0] = {{"drives", {{{"off_s", nullptr}}, {{"off_s", 5.91}}}}};
  const auto findings = Result();
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].kind, "error");
  EXPECT_NEAR(*findings[0].at_s, 6.0, 1e-9);
  EXPECT_EQ(
      findings[0].text,
      "arm 3 was 35.2 mm from the leader at 6.130 s (criterion.error_max_m is 20 mm); drive 2 off at 5.910 "
      "s; woken 8.2 ms late at 5.900 s, 4.4 ms from sample to torque at 5.950 s");
}

TEST_F(DiagnosisTest, OfAnArmThatStoppedItIsThatMomentWhateverItsErrorWas) {
  Stop(3, 800, ControllerState::kSafeStop, Cause::kTorquesUnsent);
  MetricsOf(3).max_m = 0.0352;
  MetricsOf(3).beyond_at_s = 5.0;
  TicksOf(3)[795].sample_to_torque_us = 4400;
  const auto findings = Result();
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].kind, "stopped");
  EXPECT_NEAR(*findings[0].at_s, 8.0, 1e-9);
  EXPECT_THAT(findings[0].text, HasSubstr("35.2 mm"));
  EXPECT_THAT(findings[0].text, HasSubstr("; 4.4 ms from sample to torque at 7.950 s"));
}

TEST_F(DiagnosisTest, ACauseOfLongBeforeIsToldWhereTheMomentHasNone) {
  MetricsOf(3).max_m = 0.0352;
  MetricsOf(3).beyond_at_s = 6.0;
  TicksOf(3)[100].wakeup_lateness_us = 9900;
  EXPECT_THAT(Result()[0].text, HasSubstr("; before: woken 9.9 ms late at 1.000 s"));
}

TEST_F(DiagnosisTest, WhereNothingWasLateItIsTheController) {
  MetricsOf(3).max_m = 0.5;
  MetricsOf(3).beyond_at_s = 5.0;
  const auto findings = Result();
  ASSERT_EQ(findings.size(), 2u);
  EXPECT_EQ(findings[0].kind, "error");
  EXPECT_THAT(findings[0].text, HasSubstr("diverged"));
  EXPECT_THAT(findings[0].text, HasSubstr("nothing was late or lost on its board before"));
  EXPECT_EQ(findings[1].kind, "none");
  EXPECT_THAT(findings[1].text, HasSubstr("`armada sim some.toml --seed 4`"));
}

TEST_F(DiagnosisTest, FaultsThatWereOrderedComeFirst) {
  evidence_.faults_made = {{"killed", "arm 7", 4.0, 4.0001}, {"killed", "arm 3", 9.0, 9.0}};
  scenario_.faults = {{.kind = FaultKind::kBusLoss, .at_s = 2.0, .arm = 3}};
  TicksOf(7).resize(400);
  MetricsOf(7).max_m = 0.1;
  MetricsOf(7).beyond_at_s = 5.0;
  MetricsOf(7).state = "DEAD";
  const auto findings = Result();
  ASSERT_EQ(findings.size(), 3u) << "the later fault cannot be a cause";
  EXPECT_EQ(findings[0].text, "fault bus_loss, arm 3, at 2.000 s, as was ordered");
  EXPECT_EQ(findings[1].text, "arm 7: killed at 4.000 s, as was ordered");
  EXPECT_THAT(findings[2].text, HasSubstr("; last heard at 3.990 s"));
}

TEST_F(DiagnosisTest, LossesOfABoardAndOfTheEmulationAreTold) {
  Stop(3, 900, ControllerState::kSafeStop, Cause::kTorquesUnsent);
  boards_[0] = {
      {"timing",
       {{"missed_ticks", 0}, {"incomplete_samples", 4}, {"unsent_ticks", 2}, {"realtime_priority", false}}},
      {"bus",
       {{"can_dropped", 3},
        {"can_dropped_late", 4},
        {"can_receive_overflowed", 0},
        {"can_errors", 0},
        {"lcm_overflowed", 0},
        {"lcm_rejected", 0},
        {"lcm_heard", {{{"from", 0}, {"accepted", 900}, {"missed", 5}}}}}}};
  evidence_.hil = {
      {"timing", {{"pacing_us", {{"max", 41234.0}}}, {"latest_at_s", 8.9}, {"realtime_priority", true}}}};
  const auto findings = Result();
  ASSERT_EQ(findings.size(), 4u);
  EXPECT_EQ(findings[3].text,
            "arm 3 in the whole run: ticks without every sample 4, ticks whose torques were not on the wire "
            "in time 2, "
            "dropped CAN frames 7, missed messages of the leader: 5");
  EXPECT_EQ(findings[1].text, "the emulation (armada-hil) was 41.2 ms late at 8.900 s");
  EXPECT_EQ(findings[2].kind, "priority");
}

TEST_F(DiagnosisTest, ALeaderThatWasSilentIsNamed) {
  Stop(3, 800, ControllerState::kHold, Cause::kLeaderLost);
  evidence_.leader_silences = {{5.0, 5.4}, {7.894, 8.204}};
  const auto findings = Result();
  ASSERT_EQ(findings.size(), 2u) << "something was lost";
  EXPECT_EQ(findings[1].kind, "leader");
  EXPECT_EQ(findings[1].arm_id, 0);
  EXPECT_NEAR(*findings[1].at_s, 8.204, 1e-9);
  EXPECT_EQ(findings[1].text, "the leader was not heard for 0.310 s until 8.204 s")
      << "not the longer time, which is of no failure";
}

TEST_F(DiagnosisTest, ALeaderThatWasSilentLongBeforeIsNoCause) {
  Stop(3, 800, ControllerState::kHold, Cause::kSingular);
  evidence_.leader_silences = {{5.0, 5.4}};
  const auto findings = Result();
  ASSERT_EQ(findings.size(), 3u);
  EXPECT_EQ(findings[1].kind, "none");
  EXPECT_EQ(findings[2].kind, "leader");
}

TEST_F(DiagnosisTest, ALeaderThatWasStoppedByOrderIsToldOnce) {
  Stop(3, 800, ControllerState::kHold, Cause::kLeaderLost);
  evidence_.faults_made = {{"stopped", "leader", 7.5, 7.5001}};
  evidence_.leader_silences = {{7.5002, 9.99}};
  const auto findings = Result();
  ASSERT_EQ(findings.size(), 2u);
  EXPECT_EQ(findings[0].kind, "fault");
  EXPECT_EQ(findings[1].kind, "stopped");
}

TEST_F(DiagnosisTest, OfARunThatIsOkTheLeadersSilenceIsNotTold) {
  evidence_.leader_silences = {{5.0, 5.4}};
  EXPECT_TRUE(Result().empty());
}

TEST_F(DiagnosisTest, ARunThatBrokeOffNamesWhoWasNotHeard) {
  evidence_.broke_off =
      "arm 7 (pid 5) was ended by signal 9 (SIGKILL); the end of its.txt:\n  more\n  its last words";
  evidence_.broke_off_s = 4.5;
  TicksOf(3).resize(450);
  TicksOf(7).clear();
  const auto findings = Result();
  ASSERT_EQ(findings.size(), 2u);
  EXPECT_EQ(findings[0].text,
            "the run broke off at 4.500 s: arm 7 (pid 5) was ended by signal 9 (SIGKILL): its last words");
  EXPECT_EQ(findings[1].kind, "not_heard");
}

TEST_F(DiagnosisTest, ABusyMachineThatStartsProgramsLateIsNamed) {
  evidence_.broke_off = "arm 3 (pid 5) exited with code 1; its log its.txt is empty";
  evidence_.broke_off_s = 0.1;
  evidence_.started_s = -0.7;
  for (const int id : {3, 7}) TicksOf(id).clear();
  const auto findings = Result();
  ASSERT_EQ(findings.size(), 2u) << "so early nobody can have been heard";
  EXPECT_EQ(findings[0].kind, "program");
  EXPECT_EQ(
      findings[1].text,
      "the last program was started at 0.700 s before the start; timing.bring_up_s is 1 s: the machine was "
      "busy");
}

TEST_F(DiagnosisTest, EveryMissHasAFinding) {
  scenario_.criterion.fleet_rms_max_m = 1e-9;
  scenario_.criterion.kind = CriterionKind::kAgreement;
  metrics_.estimate_spread_m = 0.1;
  scenario_.criterion.standing = {7};
  MetricsOf(7).joint_speed_max_rad_s = 2.0;
  MetricsOf(3).rms_m = 0.001;
  std::vector<std::string> kinds;
  for (const RunFinding& finding : Result()) kinds.push_back(finding.kind);
  EXPECT_THAT(kinds, testing::UnorderedElementsAre("fleet_rms", "agreement", "moved", "none"));
}

/// A leader of 100 Hz and a board, as the recorder hears them; each test leaves some of it out.
class LeaderSilenceTest : public testing::Test {
 protected:
  LeaderSilenceTest() {
    scenario_.seconds = kSeconds;
    scenario_.leader.axes.resize(2);
    scenario_.fleet.arms.emplace_back().id = 3;
  }

  void Hear(std::string_view channel, double at_s, std::span<const uint8_t> payload) {
    recorder_->OnMessage({channel, payload, At(at_s)});
  }
  /// From then to then, counted on.
  void Lead(double from_s, double to_s) {
    for (double t_s = from_s; t_s < to_s - 1e-9; t_s += 0.01) {
      MessageBuffer buffer;
      leader_t message{};
      message.stamp_ns = At(t_s);
      message.sequence = ++sequence_;
      message.task_dim = 2;
      Hear(kLeaderChannel, t_s, sealer_.Seal(kLeaderChannel, Encode(message, &buffer), &buffer));
    }
  }
  /// Whatever is heard of others tells that the recorder still hears.
  void HearOthersUntil(double t_s) { Hear("OTHERS", t_s, {}); }

  std::vector<Silence> Silences() const { return recorder_->LeaderSilences(); }
  void Start() { recorder_.emplace(scenario_, kEpoch_ns, key_); }

  FleetKey key_{};
  ScenarioConfig scenario_;
  std::optional<RunRecorder> recorder_;
  Sealer sealer_{{key_, 1}, kLeaderSender};
  int64_t sequence_ = 0;
};

TEST_F(LeaderSilenceTest, OfALeaderThatIsHeardFromBeforeTheStartToTheEndThereIsNone) {
  Start();
  Lead(-1.5, -1.0);
  Lead(-0.5, kSeconds);
  HearOthersUntil(kSeconds + 0.5);
  EXPECT_TRUE(Silences().empty());
}

TEST_F(LeaderSilenceTest, ALeaderThatWasStoppedIsSilentThoughItsSequenceSkipsNothing) {
  Start();
  Lead(0.0, 4.9);
  Lead(5.2, kSeconds);
  HearOthersUntil(kSeconds);
  const auto silences = Silences();
  ASSERT_EQ(silences.size(), 1u);
  EXPECT_NEAR(silences[0].begin_s, 4.89, 1e-6);
  EXPECT_NEAR(silences[0].end_s, 5.2, 1e-6);
}

TEST_F(LeaderSilenceTest, MessagesThatWereLostOnTheWayAreNoneOfIt) {
  Start();
  Lead(0.0, 4.9);
  sequence_ += 30;
  Lead(5.2, kSeconds);
  HearOthersUntil(kSeconds);
  EXPECT_TRUE(Silences().empty());
}

TEST_F(LeaderSilenceTest, ItLastsFromTheStartOrUntilTheEndAsLongAsAnybodyIsHeard) {
  Start();
  Lead(0.5, 6.0);
  EXPECT_EQ(Silences().size(), 1u);
  HearOthersUntil(7.0);
  const auto silences = Silences();
  ASSERT_EQ(silences.size(), 2u);
  EXPECT_NEAR(silences[0].begin_s, 0.0, 1e-6);
  EXPECT_NEAR(silences[0].end_s, 0.5, 1e-6);
  EXPECT_NEAR(silences[1].begin_s, 5.99, 1e-6);
  EXPECT_NEAR(silences[1].end_s, 7.0, 1e-6);
}

TEST_F(LeaderSilenceTest, WhatComesAfterTheEndIsOfNoRun) {
  Start();
  Lead(0.0, kSeconds - 0.2);
  Lead(kSeconds + 0.5, kSeconds + 0.505);
  HearOthersUntil(kSeconds + 2.0);
  const auto silences = Silences();
  ASSERT_EQ(silences.size(), 1u);
  EXPECT_NEAR(silences[0].end_s, kSeconds, 1e-6);
}

TEST_F(LeaderSilenceTest, WithoutALeaderThereIsNone) {
  scenario_.leader.kind = LeaderKind::kNone;
  Start();
  HearOthersUntil(7.0);
  EXPECT_TRUE(Silences().empty());
}

TEST_F(DiagnosisTest, FindingsArePrintedALineEachAndWrittenAsObjects) {
  const std::vector<RunFinding> findings = {{"stall", 0, 1.5, "first"}, {"error", 3, std::nullopt, "second"}};
  std::ostringstream out;
  PrintFindings(findings, false, out);
  EXPECT_EQ(out.str(), "why it is not ok:\n  first\n  second\n");
  EXPECT_EQ(ToJson(findings).dump(), R"([{"kind":"stall","arm":null,"at_s":1.5,"text":"first"},)"
                                     R"({"kind":"error","arm":3,"at_s":null,"text":"second"}])");
}

}  // namespace
}  // namespace armada
