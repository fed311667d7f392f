#include "hil/odrive_emulator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "firmware/can/odrive_cansimple.h"
#include "tests/support/limit_malloc.h"

namespace armada {
namespace {

using odrive::AxisState;
using odrive::ControlMode;
using odrive::Firmware;
using odrive::InputMode;

constexpr int kNode = 3;
constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr JointTruth kTruth{0.7, -1.5};

JointDriveConfig ODriveJoint(Firmware firmware = Firmware::kV06) {
  JointDriveConfig joint;
  joint.profile =
      firmware == Firmware::kV05 ? DriveProfile::kODriveCanSimpleV05 : DriveProfile::kODriveCanSimple;
  joint.node_id = kNode;
  joint.gear_ratio = 10.0;
  joint.direction = -1.0;
  joint.offset_rad = 0.5;
  joint.torque_limit_Nm = 150.0;
  return joint;
}

/// An emulated axis with a bus that keeps what it sends.
class ODriveBench {
 public:
  explicit ODriveBench(const EmulatedDriveConfig& config = {}, uint64_t seed = 1,
                       Firmware generation = Firmware::kV06)
      : firmware(generation), axis(ODriveJoint(generation), config, seed) {}

  void Send(double t_s, const CanFrame& frame) { axis.OnFrame(t_s, frame, kTruth, &sent); }
  void Advance(double t_s) { axis.OnTime(t_s, kTruth, &sent); }
  void SetTorque(double t_s, float motor_Nm) { Send(t_s, odrive::EncodeSetInputTorque(kNode, motor_Nm)); }
  void Arm(double t_s) {
    Send(t_s, odrive::EncodeClearErrors(kNode));
    Send(t_s, odrive::EncodeSetControllerMode(kNode, {ControlMode::kTorque, InputMode::kPassthrough}));
    Send(t_s, odrive::EncodeSetAxisState(kNode, AxisState::kClosedLoop));
  }
  odrive::Heartbeat Heartbeat(double t_s) {
    CanFrame request;
    request.id = kNode << 5 | 1;
    request.remote = true;
    request.length = 8;
    sent.Clear();
    Send(t_s, request);
    odrive::Heartbeat heartbeat;
    EXPECT_EQ(sent.size(), 1u);
    EXPECT_TRUE(odrive::DecodeHeartbeat(sent[0], kNode, firmware, &heartbeat));
    return heartbeat;
  }
  odrive::EncoderEstimates Estimates(double t_s, const JointTruth& truth) {
    sent.Clear();
    axis.OnFrame(t_s, odrive::EncodeEncoderRequest(kNode), truth, &sent);
    odrive::EncoderEstimates estimates;
    EXPECT_EQ(sent.size(), 1u);
    EXPECT_TRUE(odrive::DecodeEncoderEstimates(sent[0], kNode, &estimates));
    return estimates;
  }

  Firmware firmware;
  ODriveEmulator axis;
  FrameList sent;
};

EmulatedDriveConfig NoWatchdog() {
  EmulatedDriveConfig config;
  config.watchdog_s = 0.0;
  return config;
}

TEST(ODriveEmulator, ATorqueHoldsFromOneLatencyAfterItsFrame) {
  ODriveBench bench;
  bench.Arm(1.0);
  bench.SetTorque(1.010, 2.0f);
  bench.SetTorque(1.020, -3.0f);
  EXPECT_EQ(bench.axis.Torque(1.020), -20.0) << "direction -1, gear 10";
  EXPECT_EQ(bench.axis.Torque(std::nextafter(1.020 + 0.001, 0.0)), -20.0);
  EXPECT_EQ(bench.axis.Torque(1.020 + 0.001), 30.0);
}

TEST(ODriveEmulator, SeveralTorquesWithinOneLatencyAllTakeTheirTurn) {
  EmulatedDriveConfig config;
  config.latency_s = 0.005;
  ODriveBench bench(config);
  bench.Arm(1.0);
  for (int k = 1; k <= 4; ++k) bench.SetTorque(1.0 + 0.001 * k, static_cast<float>(k));
  EXPECT_EQ(bench.axis.Torque(1.0055), 0.0);
  for (int k = 1; k <= 4; ++k) {
    EXPECT_EQ(bench.axis.NextTorqueChange(1.0045 + 0.001 * k), 1.0 + 0.001 * k + 0.005);
    EXPECT_EQ(bench.axis.Torque(1.0055 + 0.001 * k), -10.0 * k);
  }
}

TEST(ODriveEmulator, MoreTorquesThanThereIsRoomForEndWithTheLast) {
  EmulatedDriveConfig config;
  config.latency_s = 0.01;
  ODriveBench bench(config);
  bench.Arm(1.0);
  for (int k = 1; k <= 50; ++k) bench.SetTorque(1.0 + 0.0001 * k, static_cast<float>(0.1 * k));
  EXPECT_FLOAT_EQ(static_cast<float>(bench.axis.Torque(1.02)), -50.0f);
}

TEST(ODriveEmulator, HasATorqueLimitOfItsOwn) {
  ODriveBench bench;
  bench.Arm(1.0);
  bench.SetTorque(1.0, 1e9f);
  EXPECT_EQ(bench.axis.Torque(1.002), -150.0);
  bench.SetTorque(1.002, -1e9f);
  EXPECT_EQ(bench.axis.Torque(1.004), 150.0);
}

TEST(ODriveEmulator, TorqueThatIsNotFiniteIsNotTaken) {
  ODriveBench bench;
  bench.Arm(1.0);
  bench.SetTorque(1.0, 2.0f);
  bench.SetTorque(1.001, NAN);
  bench.SetTorque(1.001, INFINITY);
  EXPECT_EQ(bench.axis.Torque(1.01), -20.0);
}

TEST(ODriveEmulator, ProducesNothingUnlessInClosedLoopAndInTorqueControl) {
  ODriveBench bench(NoWatchdog());
  bench.SetTorque(1.0, 2.0f);
  EXPECT_EQ(bench.axis.Torque(2.0), 0.0) << "idle";
  EXPECT_FALSE(bench.axis.ProducesTorque());
  bench.Send(2.0, odrive::EncodeSetAxisState(kNode, AxisState::kClosedLoop));
  EXPECT_EQ(bench.axis.Torque(3.0), 0.0) << "position control, as after power-up";
  bench.Send(3.0, odrive::EncodeSetControllerMode(kNode, {ControlMode::kTorque, InputMode::kPassthrough}));
  EXPECT_EQ(bench.axis.Torque(4.0), -20.0) << "the input has been kept";
  EXPECT_TRUE(bench.axis.ProducesTorque());
  bench.Send(4.0, odrive::EncodeSetAxisState(kNode, AxisState::kIdle));
  EXPECT_EQ(bench.axis.Torque(4.0005), -20.0);
  EXPECT_EQ(bench.axis.Torque(4.001), 0.0);
  EXPECT_FALSE(bench.axis.ProducesTorque());
}

std::string Name(const testing::TestParamInfo<Firmware>& info) {
  return info.param == Firmware::kV05 ? "V05" : "V06";
}
class Generation : public testing::TestWithParam<Firmware> {};
INSTANTIATE_TEST_SUITE_P(Both, Generation, testing::Values(Firmware::kV05, Firmware::kV06), Name);

TEST_P(Generation, SilenceTripsTheWatchdogAtItsTimeAndLatchesAnError) {
  ODriveBench bench({}, 1, GetParam());
  bench.Arm(1.0);
  bench.SetTorque(1.0, 2.0f);
  const double expiry_s = 1.0 + 0.03;
  EXPECT_EQ(bench.axis.NextTorqueChange(1.01), expiry_s);
  EXPECT_EQ(bench.axis.Torque(std::nextafter(expiry_s, 0.0)), -20.0);
  EXPECT_EQ(bench.axis.Torque(expiry_s), 0.0) << "without anyone calling OnTime";
  bench.Advance(expiry_s);
  EXPECT_FALSE(bench.axis.ProducesTorque());
  EXPECT_EQ(bench.axis.NextTorqueChange(expiry_s), kNever);

  bench.SetTorque(1.04, 2.0f);
  bench.Send(1.04, odrive::EncodeSetAxisState(kNode, AxisState::kClosedLoop));
  EXPECT_EQ(bench.axis.Torque(1.05), 0.0) << "latched";
  EXPECT_EQ(bench.Heartbeat(1.05).error, odrive::WatchdogError(GetParam()));
  EXPECT_EQ(bench.Heartbeat(1.05).state, AxisState::kIdle);

  bench.Send(1.06, odrive::EncodeClearErrors(kNode));
  EXPECT_EQ(bench.axis.Torque(1.07), 0.0) << "clearing does not arm";
  EXPECT_EQ(bench.Heartbeat(1.07).error, 0u);
  bench.Send(1.07, odrive::EncodeSetAxisState(kNode, AxisState::kClosedLoop));
  EXPECT_EQ(bench.axis.Torque(1.08), -20.0) << "the input has been kept";
}

TEST_P(Generation, AnEmergencyStopDisarmsAndLatches) {
  ODriveBench bench(NoWatchdog(), 1, GetParam());
  bench.Arm(1.0);
  bench.SetTorque(1.0, 2.0f);
  bench.Send(1.01, odrive::EncodeEstop(kNode));
  EXPECT_EQ(bench.axis.Torque(1.011), 0.0);
  EXPECT_EQ(bench.Heartbeat(1.02).error, odrive::EstopError(GetParam()));
  bench.Send(1.02, odrive::EncodeSetAxisState(kNode, AxisState::kClosedLoop));
  EXPECT_FALSE(bench.axis.ProducesTorque());
}

TEST(ODriveEmulator, EveryFrameWithItsNodeIdFeedsTheWatchdogAndNoOther) {
  ODriveBench bench;
  bench.Arm(1.0);
  bench.SetTorque(1.0, 2.0f);
  bench.Send(1.02, odrive::EncodeEncoderRequest(kNode));
  EXPECT_EQ(bench.axis.Torque(1.045), -20.0);
  bench.Send(1.04, odrive::EncodeEncoderRequest(kNode + 1));
  EXPECT_EQ(bench.axis.Torque(1.055), 0.0);
}

TEST(ODriveEmulator, AWatchdogOfZeroIsOff) {
  ODriveBench bench(NoWatchdog());
  bench.Arm(1.0);
  bench.SetTorque(1.0, 2.0f);
  bench.Advance(1000.0);
  EXPECT_EQ(bench.axis.Torque(1000.0), -20.0);
  EXPECT_EQ(bench.axis.NextTorqueChange(1000.0), kNever);
}

TEST(ODriveEmulator, EstimatesAreTheJointSeenFromTheMotor) {
  ODriveBench bench;
  const odrive::EncoderEstimates estimates = bench.Estimates(0.0, {0.5 + std::numbers::pi, 2.0});
  EXPECT_FLOAT_EQ(estimates.position_turns, -5.0f) << "half a joint turn, gear 10, backwards";
  EXPECT_FLOAT_EQ(estimates.velocity_turns_s, static_cast<float>(-10.0 / std::numbers::pi));
}

TEST(ODriveEmulator, TheMastersCodecReadsBackTheJoint) {
  ODriveBench bench;
  ODriveCanSimple master(ODriveJoint());
  bench.Estimates(0.0, {-2.25, 3.5});
  ASSERT_EQ(master.OnFrame(bench.sent[0]), Reception::kTaken);
  EXPECT_NEAR(master.sample().position_rad, -2.25, 1e-6);
  EXPECT_NEAR(master.sample().velocity_rad_s, 3.5, 1e-6);
}

TEST(ODriveEmulator, PositionsAreWholeCountsWithinHalfACountOfTheTruth) {
  EmulatedDriveConfig config;
  config.encoder_counts_per_turn = 4096;
  ODriveBench bench(config);
  for (double q_rad = -3.0; q_rad < 3.0; q_rad += 0.01) {
    const double counts = 4096.0 * static_cast<double>(bench.Estimates(0.0, {q_rad, 0.0}).position_turns);
    EXPECT_EQ(counts, std::round(counts));
    EXPECT_NEAR(counts, -4096.0 * 10.0 * (q_rad - 0.5) / (2.0 * std::numbers::pi), 0.5 + 1e-9);
  }
}

TEST(ODriveEmulator, VelocityNoiseHasTheGivenDeviationAndIsTheSameForASeed) {
  EmulatedDriveConfig config = NoWatchdog();
  config.velocity_noise_rad_s = 0.2;
  ODriveBench bench(config, 11);
  ODriveBench same(config, 11);
  ODriveBench other(config, 12);
  constexpr int kSamples = 20000;
  double sum = 0.0;
  double sum_of_squares = 0.0;
  int equal_to_other = 0;
  for (int i = 0; i < kSamples; ++i) {
    const float velocity = bench.Estimates(0.0, {0.0, 0.0}).velocity_turns_s;
    ASSERT_EQ(velocity, same.Estimates(0.0, {0.0, 0.0}).velocity_turns_s);
    equal_to_other += velocity == other.Estimates(0.0, {0.0, 0.0}).velocity_turns_s;
    const double noise_rad_s = static_cast<double>(velocity) * 2.0 * std::numbers::pi / 10.0;
    sum += noise_rad_s;
    sum_of_squares += noise_rad_s * noise_rad_s;
  }
  EXPECT_NEAR(sum / kSamples, 0.0, 4.0 * 0.2 / std::sqrt(kSamples));
  EXPECT_NEAR(std::sqrt(sum_of_squares / kSamples), 0.2, 0.2 * 4.0 / std::sqrt(2.0 * kSamples));
  EXPECT_LT(equal_to_other, kSamples / 100);
}

TEST(ODriveEmulator, HeartbeatsAndCyclicEstimatesComeAtTheirTimesAndNotTwice) {
  EmulatedDriveConfig config = NoWatchdog();
  config.feedback_period_s = 0.03;
  ODriveBench bench(config);
  std::vector<double> heartbeats_s;
  std::vector<double> estimates_s;
  for (double t_s = bench.axis.NextEvent(0.0); t_s < 1.0; t_s = bench.axis.NextEvent(t_s)) {
    bench.sent.Clear();
    bench.Advance(t_s);
    ASSERT_GT(bench.sent.size(), 0u) << "at an event something happens";
    for (const CanFrame& frame : bench.sent)
      ((frame.id & 31) == 1 ? heartbeats_s : estimates_s).push_back(t_s);
    bench.sent.Clear();
    bench.Advance(t_s);
    ASSERT_EQ(bench.sent.size(), 0u);
  }
  ASSERT_EQ(heartbeats_s.size(), 10u);
  ASSERT_EQ(estimates_s.size(), 34u);
  for (size_t k = 0; k < heartbeats_s.size(); ++k)
    EXPECT_DOUBLE_EQ(heartbeats_s[k], 0.1 * static_cast<double>(k));
  for (size_t k = 0; k < estimates_s.size(); ++k)
    EXPECT_DOUBLE_EQ(estimates_s[k], 0.03 * static_cast<double>(k));
}

TEST(ODriveEmulator, WhatFellDueManyTimesIsSentOnce) {
  EmulatedDriveConfig config = NoWatchdog();
  config.feedback_period_s = 0.01;
  ODriveBench bench(config);
  bench.Advance(3600.05);
  EXPECT_EQ(bench.sent.size(), 2u);
  EXPECT_GT(bench.axis.NextEvent(3600.05), 3600.05);
  EXPECT_LT(bench.axis.NextEvent(3600.05), 3600.07);
}

TEST(ODriveEmulator, RoundingOfTheTimeSendsNothingTwice) {
  EmulatedDriveConfig config = NoWatchdog();
  config.feedback_period_s = 0.01;
  ODriveBench bench(config);
  const double t_s = 29 * 0.01;
  ASSERT_LT(t_s / 0.01, 29.0) << "a time whose quotient is rounded down";
  bench.Advance(t_s);
  EXPECT_EQ(bench.sent.size(), 2u);
  bench.Advance(t_s);
  EXPECT_EQ(bench.sent.size(), 2u);
}

TEST(ODriveEmulator, FramesItDoesNotKnowOrThatAreCutChangeNothing) {
  ODriveBench bench(NoWatchdog());
  bench.Arm(1.0);
  bench.SetTorque(1.0, 2.0f);
  CanFrame cut = odrive::EncodeSetInputTorque(kNode, 5.0f);
  cut.length = 3;
  CanFrame extended = odrive::EncodeSetInputTorque(kNode, 5.0f);
  extended.extended = true;
  CanFrame unknown = odrive::EncodeSetInputTorque(kNode, 5.0f);
  unknown.id = kNode << 5 | 0x1F;
  CanFrame calibration = odrive::EncodeSetAxisState(kNode, static_cast<AxisState>(3));
  for (const CanFrame& frame :
       {cut, extended, unknown, calibration, odrive::EncodeSetInputTorque(kNode + 1, 5.0f)}) {
    bench.Send(1.1, frame);
  }
  EXPECT_EQ(bench.axis.Torque(2.0), -20.0);
  EXPECT_EQ(bench.sent.size(), 0u);
}

/// The master's codec and the drive on a bus that may lose frames, at 100 Hz.
struct Loop {
  explicit Loop(Firmware generation) : master(ODriveJoint(generation)), bench({}, 1, generation) {}

  template <class Lose>
  void Tick(double tau_Nm, Lose lose) {
    const double t_s = 0.01 * ++ticks;
    bench.sent.Clear();
    bench.Advance(t_s);
    from_master.Clear();
    if (master.state() == DriveState::kTorque) {
      master.RequestSample(0, &from_master);
      master.CommandTorque(tau_Nm, &from_master);
    } else {
      master.BringUp(0, &from_master);
    }
    for (const CanFrame& frame : from_master) {
      if (!lose()) bench.Send(t_s, frame);
    }
    for (const CanFrame& frame : bench.sent) {
      if (!lose()) master.OnFrame(frame);
    }
  }

  ODriveCanSimple master;
  ODriveBench bench;
  FrameList from_master;
  int ticks = 0;
};

constexpr auto kLoseNothing = [] { return false; };

TEST_P(Generation, TheMasterBringsItUpFromAWatchdogErrorAndDrivesIt) {
  Loop loop(GetParam());
  for (int i = 0; i < 20; ++i)
    loop.bench.Advance(0.01 * ++loop.ticks);  // nobody feeds it: the error is there
  for (int i = 0; i < 60; ++i) loop.Tick(45.0, kLoseNothing);
  EXPECT_EQ(loop.master.state(), DriveState::kTorque);
  EXPECT_EQ(loop.master.error_code(), 0u);
  EXPECT_NEAR(loop.bench.axis.Torque(0.01 * loop.ticks + 0.005), 45.0, 1e-5);
}

TEST_P(Generation, AnInputLeftFromBeforeDoesNotFireWhenTheMasterArms) {
  Loop loop(GetParam());
  loop.bench.SetTorque(0.0, 5.0f);
  double largest_Nm = 0.0;
  for (int i = 0; i < 60; ++i) {
    loop.Tick(0.0, kLoseNothing);
    for (const double after_s : {0.0, 0.0005, 0.001, 0.009}) {
      largest_Nm = std::max(largest_Nm, std::abs(loop.bench.axis.Torque(0.01 * loop.ticks + after_s)));
    }
  }
  EXPECT_EQ(loop.master.state(), DriveState::kTorque);
  EXPECT_EQ(largest_Nm, 0.0);
}

TEST(ODriveEmulator, ABusThatLosesFramesDelaysTheBringUpButDoesNotStopIt) {
  for (uint64_t seed = 1; seed <= 100; ++seed) {
    Loop loop(Firmware::kV06);
    std::mt19937_64 random(seed);
    const auto lose_one_in_ten = [&] { return random() % 10 == 0; };
    for (int i = 0; i < 300 && loop.master.state() != DriveState::kTorque; ++i)
      loop.Tick(0.0, lose_one_in_ten);
    ASSERT_EQ(loop.master.state(), DriveState::kTorque) << "seed " << seed;
  }
}

TEST(ODriveEmulator, AfterAWatchdogTripTheMasterDoesNotArmAgainByItself) {
  Loop loop(Firmware::kV06);
  for (int i = 0; i < 60; ++i) loop.Tick(45.0, kLoseNothing);
  ASSERT_EQ(loop.master.state(), DriveState::kTorque);
  loop.ticks += 10;  // the master is silent for 100 ms
  for (int i = 0; i < 100; ++i) loop.Tick(45.0, kLoseNothing);
  EXPECT_EQ(loop.master.state(), DriveState::kFault);
  EXPECT_EQ(loop.master.error_code(), odrive::WatchdogError(Firmware::kV06));
  EXPECT_EQ(loop.bench.axis.Torque(0.01 * loop.ticks), 0.0);
  loop.master.Reset();
  for (int i = 0; i < 60; ++i) loop.Tick(45.0, kLoseNothing);
  EXPECT_EQ(loop.master.state(), DriveState::kTorque);
}

TEST(ODriveEmulator, NothingAllocates) {
  EmulatedDriveConfig config;
  config.velocity_noise_rad_s = 0.1;
  ODriveBench bench(config);
  const LimitMalloc guard;
  bench.Arm(0.0);
  for (int i = 0; i < 1000; ++i) {
    const double t_s = 0.001 * i;
    bench.sent.Clear();
    bench.Advance(t_s);
    bench.SetTorque(t_s, 1.0f);
    bench.Send(t_s, odrive::EncodeEncoderRequest(kNode));
  }
}

}  // namespace
}  // namespace armada
