#include "hil/faulty_drive.h"

#include <gtest/gtest.h>

#include <cmath>

#include "firmware/can/make_drive.h"
#include "firmware/can/odrive_messages.h"
#include "tests/support/limit_malloc.h"

namespace armada {
namespace {

using odrive::AxisState;

constexpr double kEnd_s = 2.0;

FaultConfig Fault(FaultSignal signal, FaultWay way, double value = 0.0) {
  FaultConfig fault;
  fault.kind = FaultKind::kDrive;
  fault.at_s = 1.0;
  fault.until_s = kEnd_s;
  fault.arm = 1;
  fault.signal = signal;
  fault.way = way;
  fault.value = value;
  return fault;
}

FaultConfig DriveError() {
  FaultConfig fault;
  fault.kind = FaultKind::kDriveError;
  fault.at_s = 1.0;
  fault.arm = 1;
  return fault;
}

JointDriveConfig Joint(DriveProfile profile = DriveProfile::kODriveCanSimple) {
  JointDriveConfig joint{.profile = profile, .node_id = 3, .torque_limit_Nm = 100.0};
  joint.mit.master_id = 0x10;
  return joint;
}

/// A drive in torque mode, whose joint turns at 1 rad/s from 0 on, commanded every 10 ms.
class Turning {
 public:
  explicit Turning(const std::vector<FaultConfig>& faults)
      : drive_(WithFaults(MakeEmulatedDrive(Joint(), {.latency_s = 0.0}, 1), Joint(), faults, 1, 1, 0.0, 7)) {
    Send(0.0,
         odrive::EncodeSetControllerMode(3, {odrive::ControlMode::kTorque, odrive::InputMode::kPassthrough}));
    Send(0.0, odrive::EncodeSetAxisState(3, AxisState::kClosedLoop));
  }

  EmulatedDrive& drive() { return *drive_; }

  /// Goes on until `t_s`, with a torque that is the time's.
  void AdvanceTo(double t_s) {
    for (; 0.01 * ticks_ <= t_s + 1e-9; ++ticks_) {
      const double tick_s = 0.01 * ticks_;
      for (double next_s = drive_->NextEvent(t_s_); next_s < tick_s; next_s = drive_->NextEvent(t_s_)) {
        t_s_ = next_s;
        drive_->OnTime(t_s_, Truth(), &out_);
        Take();
      }
      if (commands_) Send(tick_s, odrive::EncodeSetInputTorque(3, static_cast<float>(tick_s)));
    }
  }
  odrive::EncoderEstimates Ask(double t_s) {
    AdvanceTo(t_s);
    Send(t_s_, odrive::EncodeEncoderRequest(3));
    return estimates_;
  }
  void StopCommands() { commands_ = false; }

  int heartbeats() const { return heartbeats_; }
  const odrive::Heartbeat& heartbeat() const { return heartbeat_; }

 private:
  JointTruth Truth() const { return {t_s_, 1.0}; }

  void Send(double t_s, const CanFrame& frame) {
    t_s_ = t_s;
    drive_->OnFrame(t_s_, frame, Truth(), &out_);
    Take();
  }
  void Take() {
    for (const CanFrame& frame : out_) {
      odrive::DecodeEncoderEstimates(frame, 3, &estimates_);
      if (odrive::DecodeHeartbeat(frame, 3, odrive::Firmware::kV06, &heartbeat_)) ++heartbeats_;
    }
    out_.Clear();
  }

  std::unique_ptr<EmulatedDrive> drive_;
  double t_s_ = 0.0;
  int ticks_ = 1;
  bool commands_ = true;
  FrameList out_;
  odrive::EncoderEstimates estimates_;
  odrive::Heartbeat heartbeat_;
  int heartbeats_ = 0;
};

TEST(FaultyDrive, IsTheDriveItselfWhereNoFaultIsItsOwn) {
  FaultConfig other_arm = Fault(FaultSignal::kPosition, FaultWay::kOff);
  other_arm.arm = 2;
  FaultConfig other_joint = Fault(FaultSignal::kPosition, FaultWay::kOff);
  other_joint.joint = 2;
  auto drive = MakeEmulatedDrive(Joint(), {}, 1);
  const EmulatedDrive* const before = drive.get();
  drive = WithFaults(std::move(drive), Joint(), {other_arm, other_joint}, 1, 1, 0.0, 7);
  EXPECT_EQ(drive.get(), before);
  drive = WithFaults(std::move(drive), Joint(), {other_joint}, 1, 2, 0.0, 7);
  EXPECT_NE(drive.get(), before);
}

TEST(FaultyDrive, AStuckPositionRepeatsToTheBitWhileTheJointTurns) {
  Turning turning({Fault(FaultSignal::kPosition, FaultWay::kStuck)});
  const float before = turning.Ask(0.99).position_turns;
  const float stuck = turning.Ask(1.01).position_turns;
  EXPECT_GT(stuck, before);
  for (double t_s = 1.02; t_s < kEnd_s - 0.005; t_s += 0.05) {
    const odrive::EncoderEstimates told = turning.Ask(t_s);
    EXPECT_EQ(told.position_turns, stuck);
    EXPECT_GT(told.velocity_turns_s, 0.1f);
  }
  EXPECT_GT(turning.Ask(kEnd_s + 0.01).position_turns, stuck + 0.1f);
}

TEST(FaultyDrive, FaultsOfOneSignalAddUp) {
  Turning plain({});
  Turning turning({Fault(FaultSignal::kVelocity, FaultWay::kWrong, 2.0),
                   Fault(FaultSignal::kVelocity, FaultWay::kWrong, 1.0)});
  EXPECT_EQ(turning.Ask(0.9).velocity_turns_s, plain.Ask(0.9).velocity_turns_s);
  EXPECT_FLOAT_EQ(turning.Ask(1.1).velocity_turns_s, 4.0f * plain.Ask(1.1).velocity_turns_s);
}

TEST(FaultyDrive, CurrentIsWhatTheJointGetsNotWhatTheDriveMeans) {
  Turning off({Fault(FaultSignal::kCurrent, FaultWay::kOff)});
  Turning stuck({Fault(FaultSignal::kCurrent, FaultWay::kStuck)});
  Turning reversed({Fault(FaultSignal::kCurrent, FaultWay::kWrong, -1.0)});
  Turning delayed({Fault(FaultSignal::kCurrent, FaultWay::kDelayed, 0.05)});
  for (Turning* turning : {&off, &stuck, &reversed, &delayed}) turning->AdvanceTo(0.9);
  EXPECT_FLOAT_EQ(static_cast<float>(stuck.drive().Torque(0.9)), 0.9f);
  for (Turning* turning : {&off, &stuck, &reversed, &delayed}) turning->AdvanceTo(1.5);
  EXPECT_EQ(off.drive().Torque(1.5), 0.0);
  EXPECT_NEAR(stuck.drive().Torque(1.5), 1.0, 0.011);
  EXPECT_NEAR(reversed.drive().Torque(1.5), -1.5, 1e-6);
  EXPECT_NEAR(delayed.drive().Torque(1.5), 1.45, 0.011);
}

TEST(FaultyDrive, AStuckCurrentEndsWithThePower) {
  Turning turning({Fault(FaultSignal::kCurrent, FaultWay::kStuck)});
  turning.AdvanceTo(1.2);
  EXPECT_GT(turning.drive().Torque(1.2), 0.9);
  turning.StopCommands();
  turning.AdvanceTo(1.3);  // 30 ms of them are the watchdog's
  EXPECT_EQ(turning.drive().Torque(1.3), 0.0);
}

TEST(FaultyDrive, WithoutStatusItsHeartbeatsAreMissing) {
  Turning turning({Fault(FaultSignal::kStatus, FaultWay::kOff)});
  turning.AdvanceTo(0.99);
  const int before = turning.heartbeats();
  EXPECT_NEAR(before, 10, 1);
  turning.AdvanceTo(1.95);
  EXPECT_EQ(turning.heartbeats(), before);
  turning.AdvanceTo(2.45);
  EXPECT_NEAR(turning.heartbeats(), before + 5, 1);
}

TEST(FaultyDrive, AStuckStatusHidesThatItFailed) {
  FaultConfig error = DriveError();
  error.at_s = 1.2;
  Turning turning({Fault(FaultSignal::kStatus, FaultWay::kStuck), error});
  turning.AdvanceTo(1.9);
  EXPECT_FALSE(turning.drive().ProducesTorque());
  EXPECT_EQ(turning.heartbeat().state, AxisState::kClosedLoop);
  EXPECT_EQ(turning.heartbeat().error, 0u);
  turning.AdvanceTo(2.2);
  EXPECT_EQ(turning.heartbeat().state, AxisState::kIdle);
  EXPECT_NE(turning.heartbeat().error, 0u);
}

TEST(FaultyDrive, AWrongStatusClaimsAnErrorThatIsNone) {
  Turning turning({Fault(FaultSignal::kStatus, FaultWay::kWrong)});
  turning.AdvanceTo(1.5);
  EXPECT_TRUE(turning.drive().ProducesTorque());
  EXPECT_NE(turning.heartbeat().error, 0u);
  EXPECT_EQ(turning.heartbeat().state, AxisState::kIdle);
}

TEST(FaultyDrive, ADelayedStatusTellsOfTheErrorLater) {
  Turning turning({Fault(FaultSignal::kStatus, FaultWay::kDelayed, 0.1), DriveError()});
  turning.AdvanceTo(1.05);
  EXPECT_FALSE(turning.drive().ProducesTorque());
  EXPECT_EQ(turning.heartbeat().error, 0u);
  turning.AdvanceTo(1.35);
  EXPECT_NE(turning.heartbeat().error, 0u);
}

TEST(FaultyDrive, SlowAndIntermittentStatusComeLessOften) {
  Turning slow({Fault(FaultSignal::kStatus, FaultWay::kSlow, 0.25)});
  Turning intermittent({Fault(FaultSignal::kStatus, FaultWay::kIntermittent, 0.5)});
  slow.AdvanceTo(2.0);
  intermittent.AdvanceTo(2.0);
  EXPECT_NEAR(slow.heartbeats(), 10 + 4, 2);
  EXPECT_NEAR(intermittent.heartbeats(), 10 + 5, 4);
}

TEST(FaultyDrive, HasNoHeapInItsLoop) {
  Turning turning({Fault(FaultSignal::kStatus, FaultWay::kGarbage),
                   Fault(FaultSignal::kPosition, FaultWay::kDelayed, 0.05),
                   Fault(FaultSignal::kCurrent, FaultWay::kGarbage, 3.0), DriveError()});
  const LimitMalloc guard;
  turning.AdvanceTo(2.5);
}

/// Every profile: the bits of its status are found in what it sends.
class FaultyDriveOfProfile : public testing::TestWithParam<DriveProfile> {};

// A master brings the drive up; after the fault's begin it sees a drive that is not in torque mode.
TEST_P(FaultyDriveOfProfile, TellsItsMasterOfAnErrorRealOrNot) {
  constexpr int kUpTick = 190;
  for (FaultConfig fault : {Fault(FaultSignal::kStatus, FaultWay::kWrong), DriveError()}) {
    fault.at_s = 2.0;
    fault.until_s = FaultConfig::kForGood_s;
    JointDriveConfig joint = Joint(GetParam());
    joint.watchdog_s = 0.03;
    const std::vector<JointDriveConfig> joints = {joint};
    const auto master = std::move(MakeDrives(joints)[0]);
    const auto drive = WithFaults(MakeEmulatedDrive(joint, {}, 1), joint, {fault}, 1, 1, 0.0, 7);
    FrameList sent;
    FrameList answers;
    bool was_ready = false;
    for (int tick = 0; tick < 230; ++tick) {
      const double t_s = 0.01 * tick;
      sent.Clear();
      if (tick < kUpTick) {
        master->BringUp(std::llround(1e9 * t_s), &sent);
      } else {
        master->RequestSample(std::llround(1e9 * t_s), &sent);
        master->CommandTorque(0.0, &sent);
      }
      drive->OnTime(t_s, {}, &answers);
      for (const CanFrame& frame : sent) drive->OnFrame(t_s, frame, {}, &answers);
      for (CanFrame frame : answers) {
        frame.stamp_ns = std::llround(1e9 * t_s);
        master->OnFrame(frame);
      }
      answers.Clear();
      if (tick == kUpTick) was_ready = master->state() == DriveState::kTorque;
    }
    EXPECT_TRUE(was_ready);
    EXPECT_NE(master->state(), DriveState::kTorque) << master->Explain();
  }
}

INSTANTIATE_TEST_SUITE_P(All, FaultyDriveOfProfile,
                         testing::Values(DriveProfile::kODriveCanSimple, DriveProfile::kODriveCanSimpleV05,
                                         DriveProfile::kCubeMars, DriveProfile::kDamiao,
                                         DriveProfile::kCia402, DriveProfile::kMoteus));

TEST(FaultyDrive, OfMiniCheetahSaysNothingOfItsState) {
  EXPECT_FALSE(TellsStatus(Joint(DriveProfile::kMiniCheetah)));
  EXPECT_TRUE(TellsStatus(Joint(DriveProfile::kCia402)));
}

}  // namespace
}  // namespace armada
