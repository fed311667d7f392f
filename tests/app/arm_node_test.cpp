// One board against its emulated bench and hand-made messages: what it does when the world does not behave.

#include "firmware/app/arm_node.h"

#include <gtest/gtest.h>

#include "firmware/link/channels.h"
#include "hil/emulated_arm.h"
#include "hil/scenario_file.h"
#include "tests/app/board_times.h"
#include "tests/support/limit_malloc.h"

namespace armada {
namespace {

constexpr uint32_t kEncoderEstimatesOfNode1 = 0x029;

ScenarioConfig LoadedPaperScenario() {
  std::vector<ConfigError> errors;
  auto scenario = LoadScenario(ARMADA_SOURCE_DIR "/hil/scenarios/paper.toml", {}, &errors);
  EXPECT_TRUE(errors.empty());
  return *scenario;
}

/// Arm 1 of the paper (pinned, two joints), brought up and ready for its first tick.
class Board : public testing::Test {
 protected:
  Board()
      : scenario_(LoadedPaperScenario()),
        leader_(scenario_.leader),
        start_(DrawStart(scenario_, 0, 1, &leader_)),
        node_(scenario_.fleet, 0, start_.controller, kEpochNs, {StartMode::kRunning, 0, std::nullopt}),
        bench_(scenario_, 0, 1, start_, &leader_, -0.5) {
    for (int64_t k = -50; k < 0; ++k) {
      ready_ = node_.BringUp(NanosecondsOf(k), &to_drives_);
      Carry(k);
      Advance(k + 1);
    }
  }

  double TimeOf(int64_t k) const { return 0.01 * static_cast<double>(k); }
  int64_t NanosecondsOf(int64_t k) const { return kEpochNs + k * kPeriodNs; }

  void Carry(int64_t k) {
    for (const CanFrame& frame : to_drives_) bench_.OnFrame(TimeOf(k), frame, &to_board_);
    to_drives_.Clear();
    HandOver(k);
  }
  void HandOver(int64_t k) {
    for (CanFrame frame : to_board_) {
      frame.stamp_ns = NanosecondsOf(k);
      const uint32_t node = frame.id >> 5;
      if (deaf_to_ != 0 && node == deaf_to_) continue;
      if (frame.id == kEncoderEstimatesOfNode1) {
        if (frozen_) frame.data = frozen_data_;
        frozen_data_ = frame.data;
      }
      node_.OnFrame(frame);
    }
    to_board_.Clear();
  }
  void Advance(int64_t k) {
    bench_.AdvanceTo(TimeOf(k), &to_board_);
    HandOver(k);
  }
  leader_t LeaderAt(int64_t k) const {
    const Zeta zeta = leader_.At(TimeOf(k));
    leader_t message{};
    message.stamp_ns = NanosecondsOf(k);
    message.sequence = k + 1;
    message.task_dim = 2;
    for (int c = 0; c < 2; ++c) {
      message.x_m[c] = zeta.x_m[c];
      message.v_m_s[c] = zeta.v_m_s[c];
      message.a_m_s2[c] = zeta.a_m_s2[c];
      message.jerk_m_s3[c] = leader_.Jerk(TimeOf(k))[c];
    }
    return message;
  }
  void SendLeader(int64_t k, double offset_m = 0.0) {
    leader_t message = LeaderAt(k);
    message.x_m[0] += offset_m;
    node_.OnMessage({kLeaderChannel, Encode(message, &buffer_), NanosecondsOf(k)});
  }
  void Tick(int64_t k) {
    node_.RequestSamples(NanosecondsOf(k), &to_drives_);
    Carry(k);
    if (!silent_) SendLeader(k);
    node_.Step(NanosecondsOf(k), &to_drives_);
    Carry(k);
    Advance(k + 1);
  }

  ScenarioConfig scenario_;
  LeaderPath leader_;
  ArmStart start_;
  ArmNode node_;
  EmulatedArm bench_;
  FrameList to_drives_, to_board_;
  MessageBuffer buffer_{};
  bool ready_ = false;
  bool frozen_ = false;  ///< joint 1's drive repeats its last sample
  decltype(CanFrame::data) frozen_data_{};
  bool silent_ = false;   ///< the leader is
  uint32_t deaf_to_ = 0;  ///< node whose frames are lost on the way to the board
};

TEST_F(Board, IsReadyAfterTheBringUpAndThenRuns) {
  EXPECT_TRUE(ready_);
  for (int64_t k = 0; k < 5; ++k) Tick(k);
  EXPECT_EQ(node_.state(), ControllerState::kRun);
  EXPECT_TRUE(bench_.released());
}

// It would draw those who hear it to where the leader was.
TEST_F(Board, ThatGotNoTimeForAWhileTellsNobodyOfTheLeaderBeforeItHasNewsAgain) {
  estimate_t estimate{};
  const auto leader_age_s = [&](int64_t k) {
    EXPECT_TRUE(Decode(node_.EncodeEstimate(NanosecondsOf(k), &buffer_), &estimate));
    return estimate.leader_age_s;
  };
  for (int64_t k = 0; k < 50; ++k) Tick(k);
  EXPECT_GE(leader_age_s(50), 0.0F);
  EXPECT_GE(leader_age_s(51), 0.0F) << "a missed tick is nothing";
  EXPECT_LT(leader_age_s(80), 0.0F);
  for (int64_t k = 80; k < 120; ++k) Tick(k);
  EXPECT_GE(leader_age_s(120), 0.0F);
}

TEST_F(Board, PredictsOverASingleMissingSample) {
  for (int64_t k = 0; k < 5; ++k) Tick(k);
  deaf_to_ = 1;
  Tick(5);
  EXPECT_FALSE(node_.SamplesComplete());
  deaf_to_ = 0;
  Tick(6);
  EXPECT_EQ(node_.state(), ControllerState::kRun);
}

TEST_F(Board, StopsForGoodWhenAJointStaysSilent) {
  for (int64_t k = 0; k < 5; ++k) Tick(k);
  deaf_to_ = 2;
  for (int64_t k = 5; k < 9; ++k) Tick(k);
  EXPECT_EQ(node_.state(), ControllerState::kFault);
  EXPECT_EQ(bench_.Torque(), PlanarPlant::Joints{});
  deaf_to_ = 0;
  for (int64_t k = 9; k < 40; ++k) Tick(k);
  EXPECT_EQ(node_.state(), ControllerState::kFault) << "nothing re-arms by itself";
  EXPECT_EQ(bench_.Torque(), PlanarPlant::Joints{});
}

TEST_F(Board, StopsWhenADriveRepeatsItsLastSampleForEver) {
  int64_t k = 0;
  while (k < 20 || std::abs(bench_.plant().dq_rad_s[0]) < 0.5) Tick(k++);
  const int64_t frozen_at = k;
  frozen_ = true;
  while (k < frozen_at + 50 && node_.state() != ControllerState::kFault) Tick(k++);
  EXPECT_EQ(node_.cause(), Cause::kFeedbackFrozen);
  EXPECT_LE(k - frozen_at, 5);
  EXPECT_EQ(bench_.Torque(), PlanarPlant::Joints{});
}

TEST_F(Board, StopsWhenADriveRepeatsItsLastSampleFromRest) {
  int64_t k = 0;
  while (k < 100) Tick(k++);
  ASSERT_LT(std::abs(bench_.plant().dq_rad_s[0]), 0.05);
  frozen_ = true;
  while (k < 200 && node_.state() != ControllerState::kFault) Tick(k++);
  EXPECT_EQ(node_.cause(), Cause::kFeedbackFrozen);
  EXPECT_EQ(bench_.Torque(), PlanarPlant::Joints{});
}

TEST(FrozenFeedback, AJointAtRestMayRepeatForEver) {
  FrozenFeedback feedback({0.004, 0.01, 150.0, 0.1});
  for (int k = 0; k < 100'000; ++k)
    ASSERT_FALSE(feedback.Update(1.0, k % 3 == 0 ? 0.004 : -0.004, 149.0, 0.01));
}

TEST(FrozenFeedback, AJointMayTrembleWithinItsResolution) {
  FrozenFeedback feedback({0.004, 0.01, 150.0, 0.1});
  for (int k = 0; k < 100'000; ++k) ASSERT_FALSE(feedback.Update(1.0, k % 2 == 0 ? 0.4 : -0.4, 149.0, 0.01));
}

TEST(FrozenFeedback, AMovingJointMayNotRepeat) {
  FrozenFeedback feedback({0.004, 0.01, 150.0, 0.1});
  EXPECT_FALSE(feedback.Update(1.0, -0.104, 149.0, 0.01)) << "the first sample repeats nothing";
  for (int k = 1; k <= 9; ++k) ASSERT_FALSE(feedback.Update(1.0, -0.104, 149.0, 0.01)) << k;
  EXPECT_FALSE(feedback.Update(1.0 + 1e-9, 0.104, 149.0, 0.01)) << "it has moved";
  for (int k = 1; k <= 9; ++k) ASSERT_FALSE(feedback.Update(1.0 + 1e-9, 0.104, 149.0, 0.01)) << k;
  EXPECT_FALSE(feedback.Update(1.0 + 1e-9, 0.103, 149.0, 0.01));
  EXPECT_TRUE(feedback.Update(1.0 + 1e-9, 0.104, 149.0, 0.01));
}

TEST(FrozenFeedback, AJointThatIsPushedMayNotRepeatForLong) {
  FrozenFeedback feedback({0.004, 0.01, 150.0, 0.095});
  for (int k = 0; k < 30; ++k) {
    const double torque_Nm = k % 10 != 0 ? -150.0 : -149.0;
    ASSERT_FALSE(feedback.Update(1.0, 0.0, torque_Nm, 0.01)) << k;
  }
  EXPECT_TRUE(feedback.Update(1.0, 0.0, -150.0, 0.01));
}

TEST_F(Board, WaitsForADrivesFirstSampleAsForAnyOther) {
  deaf_to_ = 2;
  Tick(0);
  EXPECT_EQ(node_.state(), ControllerState::kInit);
  EXPECT_EQ(bench_.Torque(), PlanarPlant::Joints{});
  deaf_to_ = 0;
  Tick(1);
  EXPECT_EQ(node_.state(), ControllerState::kRun);
}

TEST_F(Board, StopsWhenADriveNeverAnswers) {
  deaf_to_ = 2;
  int64_t k = 0;
  while (k < 10 && node_.state() != ControllerState::kFault) Tick(k++);
  EXPECT_EQ(k, 4) << "30 ms after the first request it is older than feedback_stale_s";
  EXPECT_EQ(node_.cause(), Cause::kFeedbackStale);
  EXPECT_EQ(bench_.Torque(), PlanarPlant::Joints{});
}

TEST_F(Board, KeepsEstimatingForItsNeighboursWhenItFails) {
  for (int64_t k = 0; k < 200; ++k) Tick(k);
  deaf_to_ = 2;
  for (int64_t k = 200; k < 300; ++k) Tick(k);
  ASSERT_EQ(node_.state(), ControllerState::kFault);
  EXPECT_EQ(node_.cause(), Cause::kFeedbackStale);
  estimate_t estimate;
  ASSERT_TRUE(Decode(node_.EncodeEstimate(NanosecondsOf(300), &buffer_), &estimate));
  EXPECT_EQ(estimate.stamp_ns, NanosecondsOf(300));
  EXPECT_GT(estimate.agreement, 100);
  const Zeta truth = leader_.At(TimeOf(300));
  EXPECT_NEAR(estimate.x_m[0], truth.x_m[0], 1e-4);
  telemetry_t telemetry{};
  node_.FillTelemetry(&telemetry);
  EXPECT_EQ(telemetry.tau_Nm[0], 0.0);
  EXPECT_EQ(telemetry.stamp_ns, NanosecondsOf(299));
}

TEST_F(Board, HoldsWithin110MillisecondsWhenTheLeaderFallsSilent) {
  for (int64_t k = 0; k < 400; ++k) Tick(k);
  ASSERT_TRUE(node_.controller().estimator().synced());
  silent_ = true;
  for (int64_t k = 400; k < 411; ++k) Tick(k);
  EXPECT_EQ(node_.state(), ControllerState::kHold);
  EXPECT_EQ(node_.cause(), Cause::kLeaderLost);
  for (int64_t k = 411; k < 600; ++k) Tick(k);
  EXPECT_FALSE(node_.controller().estimator().synced());
  for (size_t i = 0; i < 2; ++i) EXPECT_LT(std::abs(bench_.plant().dq_rad_s[i]), 0.5) << "joint " << i + 1;
}

TEST_F(Board, WithoutDrivesInTorqueModeSendsNoTorque) {
  ArmNode fresh(scenario_.fleet, 0, start_.controller, kEpochNs, {StartMode::kRunning, 0, std::nullopt});
  FrameList out;
  fresh.RequestSamples(kEpochNs, &out);
  fresh.Step(kEpochNs, &out);
  EXPECT_EQ(fresh.state(), ControllerState::kFault);
}

TEST_F(Board, DropsWhatIsOlderThanAllowed) {
  Tick(0);
  const auto deliver = [&](int64_t sent_k, int64_t arrived_k) {
    node_.OnMessage({kLeaderChannel, Encode(LeaderAt(sent_k), &buffer_), NanosecondsOf(arrived_k)});
  };
  deliver(1, 7);
  EXPECT_EQ(node_.rejected_messages().late, 1);
  deliver(3, 7);
  EXPECT_EQ(node_.rejected_messages().total(), 1) << "40 ms is not too old";
}

TEST_F(Board, DropsAStateThatCannotFollowTheLastOne) {
  for (int64_t k = 0; k < 3; ++k) Tick(k);
  const double allowed_m = 1.5 * scenario_.fleet.estimator.beta_1_m_s * 0.01;
  SendLeader(3, 1.1 * allowed_m);
  EXPECT_EQ(node_.rejected_messages().implausible, 1);
  SendLeader(4);
  SendLeader(5, 0.9 * allowed_m);
  EXPECT_EQ(node_.rejected_messages().total(), 1);
  for (int64_t k = 6; k <= 25; ++k) SendLeader(k, 2.0);
  EXPECT_EQ(node_.rejected_messages().implausible, 21);
  SendLeader(26, 2.0);
  EXPECT_EQ(node_.rejected_messages().total(), 21) << "after estimator.age_max_s it counts as started anew";
}

TEST_F(Board, OfAFleetWithAKeyBelievesSealedMessagesOnlyAndSealsItsOwn) {
  const LinkIdentity identity{{1, 2, 3}, 1};
  ArmNode node(scenario_.fleet, 0, start_.controller, kEpochNs, {StartMode::kMonitor, 0, identity});
  Sealer leader(identity, kLeaderSender);
  leader_t message{};
  message.task_dim = 2;
  message.sequence = 1;
  message.stamp_ns = kEpochNs;
  const LcmMessage open{kLeaderChannel, Encode(message, &buffer_), kEpochNs};
  node.OnMessage(open);
  EXPECT_EQ(node.rejected_messages().forged, 1);
  const LcmMessage sealed{kLeaderChannel, leader.Seal(kLeaderChannel, open.payload, &buffer_), kEpochNs};
  node.OnMessage(sealed);
  EXPECT_EQ(node.rejected_messages().total(), 1);
  node.OnMessage(sealed);
  EXPECT_EQ(node.rejected_messages().replayed, 1);

  std::span<const uint8_t> estimate = node.EncodeEstimate(kEpochNs, &buffer_);
  EXPECT_EQ(SealCheck(identity.key, 1).Open("EST_1", &estimate), SealVerdict::kGenuine);
  std::span<const uint8_t> telemetry = node.EncodeTelemetry({}, &buffer_);
  EXPECT_EQ(SealCheck(identity.key, 1).Open("TEL_1", &telemetry), SealVerdict::kGenuine);
}

TEST_F(Board, DropsAndCountsWhatIsNoMessage) {
  Tick(0);
  const std::array<uint8_t, 5> junk{1, 2, 3, 4, 5};
  node_.OnMessage({kLeaderChannel, junk, kEpochNs});
  EXPECT_EQ(node_.rejected_messages().malformed, 1);
  SendLeader(0);  // the same message again
  EXPECT_EQ(node_.rejected_messages().stale, 1);
  node_.OnMessage({"EST_5", junk, kEpochNs});  // arm 1 does not listen to arm 5
  EXPECT_EQ(node_.rejected_messages().total(), 2);
}

TEST_F(Board, CountsWhatItAcceptsOfASenderAndWhatItMisses) {
  for (const int64_t k : {0, 1, 2, 5, 6, 9}) {
    SendLeader(k);
    SendLeader(k);  // again: not accepted
  }
  const std::vector<HeardSender> heard = node_.heard_senders();
  ASSERT_EQ(heard.size(), 1u);
  EXPECT_EQ(heard[0].arm_id, 0);
  EXPECT_EQ(heard[0].accepted, 6);
  EXPECT_EQ(heard[0].missed, 4);
}

TEST_F(Board, PublishesTheEstimateThatIsValidAtTheTick) {
  for (int64_t k = 0; k < 3; ++k) Tick(k);
  estimate_t estimate;
  ASSERT_TRUE(Decode(node_.EncodeEstimate(NanosecondsOf(3), &buffer_), &estimate));
  EXPECT_EQ(estimate.arm_id, 1);
  EXPECT_EQ(estimate.stamp_ns, NanosecondsOf(3));
  EXPECT_EQ(estimate.sequence, 1);
  EXPECT_EQ(estimate.x_m[0], node_.controller().zeta().x_m[0]);
  EXPECT_EQ(estimate.jerk_m_s3[1], leader_.Jerk(TimeOf(2))[1]) << "as last heard";
}

// Its estimate is still where it started: neighbours that took it for news of the leader would go there.
TEST_F(Board, ThatComesUpTellsNobodyOfTheLeaderBeforeItsEstimateIsInItsBand) {
  ArmNode node(scenario_.fleet, 0, start_.controller, kEpochNs, {});
  estimate_t estimate{};
  int64_t k = 0;
  for (; k < 500 && !node.controller().estimator().in_band(); ++k) {
    ASSERT_TRUE(Decode(node.EncodeEstimate(NanosecondsOf(k), &buffer_), &estimate));
    ASSERT_LT(estimate.leader_age_s, 0.0F) << "tick " << k;
    node.OnMessage({kLeaderChannel, Encode(LeaderAt(k), &buffer_), NanosecondsOf(k)});
    FrameList frames;
    node.Step(NanosecondsOf(k), &frames);
  }
  EXPECT_GT(k, 5) << "the start is far off";
  ASSERT_TRUE(Decode(node.EncodeEstimate(NanosecondsOf(k), &buffer_), &estimate));
  EXPECT_GE(estimate.leader_age_s, 0.0F);
}

TEST_F(Board, ATickAllocatesNothing) {
  for (int64_t k = 0; k < 3; ++k) Tick(k);
  telemetry_t telemetry{};
  const LimitMalloc guard;
  for (int64_t k = 3; k < 200; ++k) {
    node_.EncodeEstimate(NanosecondsOf(k), &buffer_);
    Tick(k);
    node_.FillTelemetry(&telemetry);
    Encode(telemetry, &buffer_);
  }
}

}  // namespace
}  // namespace armada
