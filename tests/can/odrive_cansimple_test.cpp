#include "firmware/can/odrive_cansimple.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "tests/can/frames.h"
#include "tests/support/limit_malloc.h"

namespace armada {
namespace {

using odrive::AxisState;
using odrive::Firmware;

constexpr int kNode = 3;  // identifiers 0x60 to 0x7F
constexpr uint32_t kSomeError = 0x20;

JointDriveConfig Config(double gear_ratio = 9.0, double direction = -1.0) {
  JointDriveConfig config;
  config.node_id = kNode;
  config.gear_ratio = gear_ratio;
  config.direction = direction;
  config.offset_rad = 0.5;
  config.torque_limit_Nm = 150.0;
  return config;
}

constexpr uint32_t kExpired = odrive::WatchdogError(Firmware::kV06);

class ODrive : public testing::Test {
 protected:
  void Hear(AxisState state, uint32_t error = 0) {
    EXPECT_EQ(drive_.OnFrame(odrive::EncodeHeartbeat(kNode, Firmware::kV06, {error, state, 0})),
              Reception::kTaken);
  }
  /// Number of frames that one tick of the bring-up sends: 4 arm the axis, 1 feeds its watchdog.
  size_t Tick() {
    sent_.Clear();
    drive_.BringUp(0, &sent_);
    return sent_.size();
  }
  /// Up to a watchdog that has been seen to trip.
  void ProveWatchdog() {
    Hear(AxisState::kIdle);
    ASSERT_EQ(Tick(), 4u);
    Hear(AxisState::kIdle, kExpired);
    ASSERT_EQ(drive_.watchdog(), DriveWatchdog::kProved);
  }
  void BringUp() {
    ProveWatchdog();
    ASSERT_EQ(Tick(), 4u);
    Hear(AxisState::kClosedLoop);
    ASSERT_EQ(drive_.state(), DriveState::kTorque);
  }
  /// Torque input of the one frame that commanding `tau_Nm` gives, motor side.
  double MotorTorque(double tau_Nm) {
    sent_.Clear();
    drive_.CommandTorque(tau_Nm, &sent_);
    float motor_Nm = NAN;
    EXPECT_EQ(sent_.size(), 1u);
    EXPECT_TRUE(sent_[0].latest_only) << "of torques only the newest counts";
    EXPECT_TRUE(odrive::DecodeSetInputTorque(sent_[0], kNode, &motor_Nm));
    return motor_Nm;
  }

  ODriveCanSimple drive_{Config()};
  FrameList sent_;
};

TEST_F(ODrive, IsArmedWithTheseBytes) {
  Hear(AxisState::kIdle);
  ASSERT_EQ(Tick(), 4u);
  EXPECT_EQ(Describe(sent_[0]), Describe(DataFrame(0x78, {0}))) << "clear errors";
  EXPECT_EQ(Describe(sent_[1]), Describe(DataFrame(0x6B, {1, 0, 0, 0, 1, 0, 0, 0}))) << "torque, passthrough";
  EXPECT_EQ(Describe(sent_[2]), Describe(DataFrame(0x6E, {0, 0, 0, 0}))) << "no torque left from before";
  EXPECT_EQ(Describe(sent_[3]), Describe(DataFrame(0x67, {8, 0, 0, 0}))) << "closed loop";
}

TEST_F(ODrive, IsUnknownUntilHeardAndIsNotArmedUnheard) {
  EXPECT_EQ(drive_.state(), DriveState::kUnknown);
  EXPECT_EQ(drive_.Explain(), "no heartbeat heard");
  EXPECT_EQ(Tick(), 0u);
  Hear(AxisState::kIdle);
  EXPECT_EQ(drive_.state(), DriveState::kIdle);
  EXPECT_EQ(Tick(), 4u);
  EXPECT_EQ(drive_.state(), DriveState::kEnabling);
}

TEST_F(ODrive, IsLeftAloneOnceArmedUntilItsWatchdogHasTripped) {
  Hear(AxisState::kIdle);
  ASSERT_EQ(Tick(), 4u);
  Hear(AxisState::kClosedLoop);
  for (int tick = 0; tick < 100; ++tick) ASSERT_EQ(Tick(), 0u) << "any frame would feed it";
  EXPECT_EQ(drive_.state(), DriveState::kEnabling) << "armed, but not proved";
  Hear(AxisState::kIdle, kExpired);
  EXPECT_EQ(drive_.watchdog(), DriveWatchdog::kProved);
  EXPECT_EQ(Tick(), 4u);
  EXPECT_EQ(Tick(), 1u) << "fed from now on";
  Hear(AxisState::kClosedLoop);
  EXPECT_EQ(drive_.state(), DriveState::kTorque);
  EXPECT_EQ(Tick(), 1u);
}

TEST_F(ODrive, AWatchdogThatDoesNotTripIsRefused) {
  Hear(AxisState::kIdle);
  ASSERT_EQ(Tick(), 4u);
  int heartbeats = 0;
  while (drive_.watchdog() == DriveWatchdog::kUnproved && heartbeats < 100) {
    Hear(AxisState::kClosedLoop);
    ++heartbeats;
    Tick();
  }
  EXPECT_EQ(heartbeats, 3) << "30 ms, and two heartbeats that may have been under way";
  EXPECT_EQ(drive_.watchdog(), DriveWatchdog::kOff);
  EXPECT_EQ(drive_.state(), DriveState::kFault);
  ASSERT_EQ(sent_.size(), 1u);
  EXPECT_EQ(Describe(sent_[0]), Describe(DataFrame(0x67, {1, 0, 0, 0}))) << "disarmed again";
  EXPECT_NE(drive_.Explain().find("watchdog is off"), std::string::npos);
  EXPECT_EQ(Tick(), 0u);
}

TEST_F(ODrive, AWatchdogThatHasTrippedBeforeNeedNoFurtherProof) {
  Hear(AxisState::kIdle, kExpired);
  EXPECT_EQ(drive_.watchdog(), DriveWatchdog::kProved);
  EXPECT_EQ(Tick(), 4u);
  Hear(AxisState::kClosedLoop);
  EXPECT_EQ(drive_.state(), DriveState::kTorque);
}

TEST_F(ODrive, IsArmedAgainForTwoHeartbeatsThatDoNotConfirmIt) {
  ProveWatchdog();
  ASSERT_EQ(Tick(), 4u);
  for (int tick = 0; tick < 100; ++tick) ASSERT_EQ(Tick(), 1u) << "no rate of calls makes it faster";
  Hear(AxisState::kIdle);  // may have been under way when it was armed
  ASSERT_EQ(Tick(), 1u);
  Hear(AxisState::kIdle);
  ASSERT_EQ(Tick(), 4u);
}

TEST_F(ODrive, ADriveThatIsMerelySlowIsWaitedFor) {
  ProveWatchdog();
  for (int i = 0; i < 50; ++i) {
    Tick();
    Hear(AxisState::kIdle);
  }
  EXPECT_EQ(drive_.state(), DriveState::kEnabling);
  Hear(AxisState::kClosedLoop);
  EXPECT_EQ(drive_.state(), DriveState::kTorque);
}

TEST_F(ODrive, ClosedLoopThatWasNotAskedForIsNotTorque) {
  Hear(AxisState::kClosedLoop);
  EXPECT_EQ(drive_.state(), DriveState::kIdle) << "its control mode is unknown";
  EXPECT_EQ(Tick(), 4u);
}

TEST_F(ODrive, AnErrorThatStaysIsAFaultAfterABoundedNumberOfAttempts) {
  Hear(AxisState::kIdle, kSomeError);
  EXPECT_EQ(drive_.state(), DriveState::kIdle) << "an error from before";
  int attempts = 0;
  for (int i = 0; i < 100; ++i) {
    attempts += Tick() == 4;
    Hear(AxisState::kIdle, kSomeError);
  }
  EXPECT_EQ(attempts, JointDriveConfig().bring_up_attempts);
  EXPECT_EQ(drive_.state(), DriveState::kFault);
  EXPECT_EQ(drive_.error_code(), kSomeError);
  EXPECT_EQ(drive_.Explain(), "axis error 0x20");
}

TEST_F(ODrive, AFaultInTorqueIsFinalUntilReset) {
  BringUp();
  Hear(AxisState::kIdle, kSomeError);
  EXPECT_EQ(drive_.state(), DriveState::kFault);
  EXPECT_EQ(Tick(), 0u);
  Hear(AxisState::kIdle);  // cleared by someone else
  EXPECT_EQ(drive_.state(), DriveState::kIdle);
  EXPECT_EQ(Tick(), 0u);
  Hear(AxisState::kClosedLoop);  // armed by someone else
  EXPECT_EQ(drive_.state(), DriveState::kIdle);
  EXPECT_EQ(Tick(), 0u);
  drive_.Reset();
  BringUp();
}

TEST_F(ODrive, ADriveThatLeavesClosedLoopByItselfIsNotArmedAgain) {
  BringUp();
  Hear(AxisState::kIdle);
  EXPECT_EQ(drive_.state(), DriveState::kIdle);
  for (int i = 0; i < 10; ++i) {
    Hear(AxisState::kIdle);
    EXPECT_EQ(Tick(), 0u);
  }
}

TEST_F(ODrive, ADriveWhoseHeartbeatIsLostHasLeftTorqueMode) {
  BringUp();
  const auto period_ns = static_cast<int64_t>(1e9 * Config().odrive.heartbeat_s);
  drive_.RequestSample(3 * period_ns, &sent_);
  EXPECT_EQ(drive_.state(), DriveState::kTorque);
  drive_.RequestSample(4 * period_ns, &sent_);
  EXPECT_NE(drive_.state(), DriveState::kTorque);
  EXPECT_EQ(drive_.Explain(), "its heartbeat is lost");
  Hear(AxisState::kClosedLoop);
  EXPECT_NE(drive_.state(), DriveState::kTorque) << "not by itself";
}

TEST_F(ODrive, IsPreparedBySilenceUnlessAnEarlierMasterHasLeftItArmed) {
  sent_.Clear();
  EXPECT_FALSE(drive_.Prepare(0, &sent_));
  EXPECT_EQ(sent_.size(), 0u) << "any frame would feed the watchdog of a drive that holds a torque";
  Hear(AxisState::kClosedLoop);
  EXPECT_FALSE(drive_.Prepare(0, &sent_));
  ASSERT_EQ(sent_.size(), 1u);
  AxisState wanted{};
  EXPECT_TRUE(odrive::DecodeSetAxisState(sent_[0], kNode, &wanted));
  EXPECT_EQ(wanted, AxisState::kIdle);
  Hear(AxisState::kIdle);
  sent_.Clear();
  EXPECT_TRUE(drive_.Prepare(0, &sent_));
  EXPECT_EQ(sent_.size(), 0u);
}

TEST_F(ODrive, DisableAsksForIdleAndEndsTheBringUp) {
  ProveWatchdog();
  ASSERT_EQ(Tick(), 4u);
  sent_.Clear();
  drive_.Disable(&sent_);
  ASSERT_EQ(sent_.size(), 1u);
  EXPECT_EQ(Describe(sent_[0]), Describe(DataFrame(0x67, {1, 0, 0, 0})));
  Hear(AxisState::kClosedLoop);  // under way, or the frame was lost
  Hear(AxisState::kIdle);
  Hear(AxisState::kIdle);
  EXPECT_EQ(drive_.state(), DriveState::kIdle);
  EXPECT_EQ(Tick(), 0u);
}

TEST_F(ODrive, QuickStopIsTheDrivesEmergencyStop) {
  BringUp();
  sent_.Clear();
  drive_.QuickStop(&sent_);
  ASSERT_EQ(sent_.size(), 1u);
  EXPECT_EQ(Describe(sent_[0]), Describe(DataFrame(0x62, {})));
  EXPECT_EQ(Tick(), 0u);
}

TEST_F(ODrive, AsksTheKernelForItsOwnFramesOnly) {
  const std::vector<CanFilter> filters = drive_.Filters();
  ASSERT_EQ(filters.size(), 1u);
  EXPECT_TRUE(Passes(filters[0], odrive::EncodeHeartbeat(kNode, Firmware::kV06, {})));
  EXPECT_TRUE(Passes(filters[0], odrive::EncodeSetInputTorque(kNode, 1.0f))) << "the echo proves it was sent";
  EXPECT_FALSE(Passes(filters[0], odrive::EncodeHeartbeat(kNode + 1, Firmware::kV06, {})));
}

TEST_F(ODrive, ASampleIsAskedForWithARemoteFrame) {
  drive_.RequestSample(0, &sent_);
  ASSERT_EQ(sent_.size(), 1u);
  EXPECT_EQ(Describe(sent_[0]), "105 0 1 0 0 0 0 8 -");
}

TEST_F(ODrive, ASampleIsConvertedToTheJoint) {
  EXPECT_EQ(drive_.sample().sequence, 0u);
  CanFrame frame = odrive::EncodeEncoderEstimates(kNode, {4.5f, -9.0f});
  frame.stamp_ns = 1234;
  ASSERT_EQ(drive_.OnFrame(frame), Reception::kTaken);
  // Nine motor turns a joint turn, backwards: 4.5 turns are -half a joint turn, from 0.5 rad.
  EXPECT_DOUBLE_EQ(drive_.sample().position_rad, 0.5 - std::numbers::pi);
  EXPECT_DOUBLE_EQ(drive_.sample().velocity_rad_s, 2.0 * std::numbers::pi);
  EXPECT_EQ(drive_.sample().stamp_ns, 1234);
  EXPECT_EQ(drive_.sample().sequence, 1u);
  ASSERT_EQ(drive_.OnFrame(frame), Reception::kTaken);
  EXPECT_EQ(drive_.sample().sequence, 2u);
}

TEST_F(ODrive, BadFeedbackIsAsIfItHadNotCome) {
  ASSERT_EQ(drive_.OnFrame(odrive::EncodeEncoderEstimates(kNode, {4.5f, -9.0f})), Reception::kTaken);
  const double position_rad = drive_.sample().position_rad;
  CanFrame cut = odrive::EncodeEncoderEstimates(kNode, {1.0f, 1.0f});
  cut.length = 7;
  for (const CanFrame& bad : {cut, odrive::EncodeEncoderEstimates(kNode, {NAN, 1.0f}),
                              odrive::EncodeEncoderEstimates(kNode, {1.0f, INFINITY})}) {
    EXPECT_EQ(drive_.OnFrame(bad), Reception::kMalformed) << Describe(bad);
  }
  for (const CanFrame& others :
       {odrive::EncodeEncoderEstimates(kNode + 1, {1.0f, 1.0f}), odrive::EncodeEncoderRequest(kNode),
        odrive::EncodeHeartbeat(kNode + 1, Firmware::kV06, {kSomeError, AxisState::kClosedLoop, 0}),
        odrive::EncodeSetInputTorque(kNode, 1.0f)}) {
    EXPECT_EQ(drive_.OnFrame(others), Reception::kNotMine) << Describe(others);
  }
  EXPECT_EQ(drive_.sample().sequence, 1u);
  EXPECT_EQ(drive_.sample().position_rad, position_rad);
  EXPECT_EQ(drive_.state(), DriveState::kUnknown);
}

TEST_F(ODrive, TorqueIsConvertedToTheMotor) {
  BringUp();
  EXPECT_EQ(MotorTorque(45.0), -5.0);
  EXPECT_EQ(MotorTorque(-90.0), 10.0);
  EXPECT_EQ(MotorTorque(0.0), 0.0);
}

TEST_F(ODrive, OutOfTorqueModeTorqueIsZeroWhateverIsAsked) {
  EXPECT_EQ(MotorTorque(45.0), 0.0);
  Hear(AxisState::kIdle);
  ASSERT_EQ(Tick(), 4u);
  Hear(AxisState::kClosedLoop);  // armed, to prove its watchdog
  EXPECT_EQ(MotorTorque(45.0), 0.0);
  Hear(AxisState::kIdle, kExpired);
  ASSERT_EQ(Tick(), 4u);
  Hear(AxisState::kClosedLoop);
  EXPECT_NE(MotorTorque(45.0), 0.0);
  Hear(AxisState::kIdle);
  EXPECT_EQ(MotorTorque(45.0), 0.0);
}

TEST_F(ODrive, TorqueThatIsNotFiniteIsEncodedAsZero) {
  BringUp();
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(MotorTorque(bad), 0.0);
  }
}

TEST(ODriveTorque, NeverPassesTheLimitNotEvenByRounding) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> gear(1e-3, 200.0);
  std::uniform_real_distribution<double> limit(1e-3, 500.0);
  for (int i = 0; i < 20000; ++i) {
    JointDriveConfig config = Config(gear(random), random() & 1 ? 1.0 : -1.0);
    config.torque_limit_Nm = limit(random);
    ODriveCanSimple drive(config);
    drive.OnFrame(odrive::EncodeHeartbeat(kNode, Firmware::kV06, {kExpired, AxisState::kIdle, 0}));
    FrameList arming;
    drive.BringUp(0, &arming);
    drive.OnFrame(odrive::EncodeHeartbeat(kNode, Firmware::kV06, {0, AxisState::kClosedLoop, 0}));
    ASSERT_EQ(drive.state(), DriveState::kTorque);
    const double sign = random() & 1 ? 1.0 : -1.0;
    for (const double factor : {1.0, 1.5, 1e300}) {
      FrameList sent;
      drive.CommandTorque(sign * factor * config.torque_limit_Nm, &sent);
      float motor_Nm = 0.0f;
      ASSERT_TRUE(odrive::DecodeSetInputTorque(sent[0], kNode, &motor_Nm));
      const double joint_Nm = config.direction * static_cast<double>(motor_Nm) * config.gear_ratio;
      ASSERT_GT(sign * joint_Nm, (1.0 - 2e-7) * config.torque_limit_Nm);
      // Two roundings of double precision stand between the two sides.
      ASSERT_LE(sign * joint_Nm, (1.0 + 4e-16) * config.torque_limit_Nm);
    }
  }
}

TEST(ODriveFirmware, V05AndV06HeartbeatsAreReadTheirOwnWay) {
  JointDriveConfig config = Config();
  config.profile = DriveProfile::kODriveCanSimpleV05;
  ODriveCanSimple old_drive(config);
  const CanFrame frame = DataFrame(0x61, {0, 0, 0, 0, 8, 1, 0, 0});  // 0.5: motor failed; 0.6: busy
  ASSERT_EQ(old_drive.OnFrame(frame), Reception::kTaken);
  EXPECT_EQ(old_drive.error_code(), 0x40u);
  ODriveCanSimple new_drive(Config());
  ASSERT_EQ(new_drive.OnFrame(frame), Reception::kTaken);
  EXPECT_EQ(new_drive.error_code(), 0u);
}

TEST_F(ODrive, NothingAllocates) {
  const LimitMalloc guard;
  Hear(AxisState::kIdle);
  drive_.BringUp(0, &sent_);
  drive_.OnFrame(odrive::EncodeEncoderEstimates(kNode, {4.5f, -9.0f}));
  drive_.RequestSample(0, &sent_);
  drive_.CommandTorque(1.0, &sent_);
  drive_.QuickStop(&sent_);
  drive_.Disable(&sent_);
  drive_.Reset();
}

}  // namespace
}  // namespace armada
