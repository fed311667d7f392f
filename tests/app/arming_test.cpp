// A board from power-up to motion and back as an operator takes it, with each family of drives.

#include <gtest/gtest.h>

#include "firmware/app/arm_node.h"
#include "firmware/app/config/fleet_file.h"
#include "hil/emulated_arm.h"
#include "hil/scenario_file.h"
#include "tests/app/board_times.h"

namespace armada {
namespace {

using State = ControllerState;

ScenarioConfig ScenarioWith(const std::string& drive) {
  std::vector<ConfigError> errors;
  auto scenario = LoadScenario(
      ARMADA_SOURCE_DIR "/hil/scenarios/benign.toml",
      {"arm.*.drive=\"" + drive + "\"", "disturbance.amplitude_Nm=10", "arm.*.mit.torque_max_Nm=300.0",
       "arm.*.mit.velocity_max_rad_s=20.0", "arm.*.cia402.rated_torque_Nm=100.0"},
      &errors);
  for (const ConfigError& error : errors) ADD_FAILURE() << error.message;
  return *scenario;
}

class Operated : public testing::TestWithParam<const char*> {
 protected:
  Operated()
      : scenario_(ScenarioWith(GetParam())),
        digest_(FleetDigest(scenario_.fleet)),
        leader_(scenario_.leader),
        start_(DrawStart(scenario_, 0, 1, &leader_)),
        bench_(scenario_, 0, 1, start_, &leader_, -1.0) {
    SwitchOn();
  }

  /// A new board: nothing is known of an earlier one.
  void SwitchOn() {
    node_.emplace(scenario_.fleet, 0, start_.controller, kEpochNs,
                  BoardStart{StartMode::kMonitor, digest_, std::nullopt});
  }
  double TimeOf(int64_t k) const { return 0.01 * static_cast<double>(k); }
  int64_t NanosecondsOf(int64_t k) const { return kEpochNs + k * kPeriodNs; }

  void HandOver(double t_s) {
    for (CanFrame frame : to_board_) {
      frame.stamp_ns = kEpochNs + std::llround(t_s * 1e9);
      node_->OnFrame(frame);
    }
    to_board_.Clear();
  }
  void Carry() {
    for (const CanFrame& frame : to_drives_) bench_.OnFrame(TimeOf(k_), frame, &to_board_);
    to_drives_.Clear();
    HandOver(TimeOf(k_));
  }
  void Tick() {
    estimate_t estimate{};
    Decode(node_->EncodeEstimate(NanosecondsOf(k_), &buffer_), &estimate);
    heard_ns_ = estimate.stamp_ns;
    node_->RequestSamples(NanosecondsOf(k_), &to_drives_);
    Carry();
    if (leader_speaks_) SendLeader();
    node_->Step(NanosecondsOf(k_), &to_drives_);
    Carry();
    for (int i = 1; i <= 10; ++i) {
      bench_.AdvanceTo(TimeOf(k_) + 0.001 * i, &to_board_);
      HandOver(TimeOf(k_) + 0.001 * i);
    }
    ++k_;
  }
  void TickFor(double seconds) {
    for (const int64_t end = k_ + std::llround(seconds / 0.01); k_ < end;) Tick();
  }
  bool TickUntil(State state, double limit_s) {
    for (const int64_t end = k_ + std::llround(limit_s / 0.01); k_ < end && node_->state() != state;) Tick();
    return node_->state() == state;
  }
  void SendLeader() {
    const Zeta zeta = leader_.At(TimeOf(k_));
    leader_t message{};
    message.stamp_ns = NanosecondsOf(k_);
    message.sequence = k_ + 1;
    message.task_dim = 2;
    for (int c = 0; c < 2; ++c) {
      message.x_m[c] = zeta.x_m[c];
      message.v_m_s[c] = zeta.v_m_s[c];
      message.a_m_s2[c] = zeta.a_m_s2[c];
      message.jerk_m_s3[c] = leader_.Jerk(TimeOf(k_))[c];
    }
    node_->OnMessage({kLeaderChannel, Encode(message, &buffer_), NanosecondsOf(k_)});
  }
  /// Refusals of a request made now.
  Refusals Ask(Request request) {
    command_t command{};
    command.stamp_ns = ++commands_;
    command.sequence = 1;
    command.arm_id = static_cast<int8_t>(node_->id());
    command.request = static_cast<int8_t>(request);
    command.heard_stamp_ns = heard_ns_;
    command.fleet_digest = digest_;
    node_->OnMessage({kCommandChannel, Encode(command, &buffer_), NanosecondsOf(k_)});
    Tick();
    reply_t reply{};
    EXPECT_TRUE(Decode(node_->EncodeReply(NanosecondsOf(k_), &buffer_), &reply));
    return static_cast<Refusals>(reply.refusals);
  }
  void ArmIt() {
    ASSERT_TRUE(TickUntil(State::kMonitor, 3.0)) << node_->ExplainDrives();
    TickFor(1.0);
    ASSERT_EQ(Ask(Request::kArm), 0u);
    ASSERT_TRUE(TickUntil(State::kHold, 3.0)) << NameOf(node_->state()) << " " << NameOf(node_->cause());
  }
  void StartIt() {
    ArmIt();
    TickFor(1.5);
    ASSERT_EQ(Ask(Request::kStart), 0u);
    ASSERT_EQ(node_->state(), State::kRun);
  }
  bool AnyTorque() const { return bench_.Torque() != PlanarPlant::Joints{}; }
  double speed_rad_s() const {
    double fastest = 0.0;
    for (const double dq : bench_.plant().dq_rad_s) fastest = std::max(fastest, std::abs(dq));
    return fastest;
  }

  ScenarioConfig scenario_;
  int64_t digest_;
  LeaderPath leader_;
  ArmStart start_;
  EmulatedArm bench_;
  std::optional<ArmNode> node_;
  FrameList to_drives_, to_board_;
  MessageBuffer buffer_{};
  int64_t k_ = 0;
  int64_t heard_ns_ = 0;
  int64_t commands_ = 0;
  bool leader_speaks_ = true;
};

TEST_P(Operated, ComesUpInMonitorAndStaysThereWithoutTorque) {
  ASSERT_TRUE(TickUntil(State::kMonitor, 3.0)) << node_->ExplainDrives();
  for (int i = 0; i < 500; ++i) {
    Tick();
    ASSERT_EQ(node_->state(), State::kMonitor);
    ASSERT_FALSE(AnyTorque());
  }
  EXPECT_FALSE(bench_.released());
  EXPECT_TRUE(node_->controller().estimator().synced()) << "it listens all the time";
}

TEST_P(Operated, HoldsItsPostureOnceArmedAndFollowsOnceStarted) {
  ArmIt();
  const PlanarPlant::Joints held = bench_.plant().q_rad;
  TickFor(1.5);
  for (size_t i = 0; i < static_cast<size_t>(bench_.plant().dof()); ++i)
    EXPECT_NEAR(bench_.plant().q_rad[i], held[i], 0.05) << "joint " << i + 1;
  ASSERT_EQ(Ask(Request::kStart), 0u);
  TickFor(6.0);
  EXPECT_EQ(node_->state(), State::kRun) << NameOf(node_->cause());
  EXPECT_LT(node_->controller().status().error_m, 0.02);
}

TEST_P(Operated, HoldsOnRequestDisarmsAndCanBeArmedAgain) {
  StartIt();
  TickFor(3.0);
  ASSERT_EQ(Ask(Request::kHold), 0u);
  EXPECT_EQ(node_->state(), State::kHold);
  TickFor(2.0);
  EXPECT_LT(speed_rad_s(), 0.05);
  ASSERT_EQ(Ask(Request::kReset), 0u);
  TickFor(0.1);
  EXPECT_FALSE(AnyTorque());
  EXPECT_LE(node_->state(), State::kMonitor);
  StartIt();
}

TEST_P(Operated, AnEstopBrakesAndLatches) {
  StartIt();
  TickFor(2.0);
  EXPECT_EQ(Ask(Request::kEstop), 0u);
  EXPECT_EQ(node_->state(), State::kSafeStop);
  ASSERT_TRUE(TickUntil(State::kFault, 2.0));
  TickFor(1.0);
  EXPECT_FALSE(AnyTorque());
  EXPECT_EQ(node_->cause(), Cause::kEstop);
  EXPECT_NE(Ask(Request::kArm), 0u);
  EXPECT_NE(Ask(Request::kStart), 0u);
  EXPECT_EQ(node_->state(), State::kFault);
  EXPECT_EQ(Ask(Request::kReset), 0u);
  ASSERT_TRUE(TickUntil(State::kMonitor, 3.0)) << node_->ExplainDrives();
  EXPECT_FALSE(AnyTorque());
}

TEST_P(Operated, ABoardThatStartsAnewWhileItsArmMovesStaysInMonitor) {
  StartIt();
  TickFor(2.0);
  SwitchOn();  // the drives were left as they were
  TickFor(0.05);
  for (size_t i = 0; i < 2; ++i) {
    const double power_W = bench_.Torque()[i] * bench_.plant().dq_rad_s[i];
    EXPECT_LE(power_W, 0.0) << "off by their watchdogs, or braking";
  }
  TickFor(3.0);
  EXPECT_LE(node_->state(), State::kMonitor);
  EXPECT_FALSE(AnyTorque());
}

TEST_P(Operated, ALeaderThatFallsSilentIsAHoldThatOnlyAnOperatorEnds) {
  StartIt();
  TickFor(3.0);
  leader_speaks_ = false;
  TickFor(0.11);
  EXPECT_EQ(node_->state(), State::kHold);
  EXPECT_EQ(node_->cause(), Cause::kLeaderLost);
  TickFor(1.0);
  EXPECT_NE(Ask(Request::kStart), 0u);
  leader_speaks_ = true;
  TickFor(3.0);
  EXPECT_EQ(node_->state(), State::kHold);
  EXPECT_EQ(Ask(Request::kStart), 0u);
  EXPECT_EQ(node_->state(), State::kRun);
}

TEST_P(Operated, RefusesToArmWithAnotherFleetFile) {
  ASSERT_TRUE(TickUntil(State::kMonitor, 3.0)) << node_->ExplainDrives();
  TickFor(1.0);
  ++digest_;
  EXPECT_EQ(Ask(Request::kArm), Bit(Refusal::kFleetDiffers));
  EXPECT_EQ(node_->state(), State::kMonitor);
}

INSTANTIATE_TEST_SUITE_P(Drives, Operated,
                         testing::Values("odrive_cansimple", "damiao", "cia402", "moteus", "cubemars"),
                         [](const auto& drive) { return std::string(drive.param); });

TEST(FleetDigest, IsOfWhatTheFileSaysAndNotOfWhereTheKeyIs) {
  ScenarioConfig scenario = ScenarioWith("odrive_cansimple");
  const int64_t digest = FleetDigest(scenario.fleet);
  scenario.fleet.link.key_file = "/somewhere/fleet.key";
  const int64_t with_key = FleetDigest(scenario.fleet);
  scenario.fleet.link.key_file = "/elsewhere/fleet.key";
  EXPECT_EQ(FleetDigest(scenario.fleet), with_key);
  EXPECT_NE(with_key, digest) << "a board without the key";
  scenario.fleet.link.key_file = "none";
  scenario.fleet.arms[6].control.gains.K_s_Nms_rad[0] *= 1.0 + 1e-15;
  EXPECT_NE(FleetDigest(scenario.fleet), digest);
}

}  // namespace
}  // namespace armada
