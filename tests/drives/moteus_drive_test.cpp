#include "firmware/can/moteus_drive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "hil/moteus_emulator.h"
#include "tests/can/frames.h"
#include "tests/drives/drive_bench.h"
#include "tests/support/limit_malloc.h"

namespace armada {
namespace {

using moteus::Mode;

constexpr int kMaxTicks = 80;  // 0.8 s

JointDriveConfig Joint() {
  JointDriveConfig joint;
  joint.profile = DriveProfile::kMoteus;
  joint.node_id = 5;
  joint.gear_ratio = 2.0;
  joint.direction = -1.0;
  joint.offset_rad = 0.5;
  joint.torque_limit_Nm = 12.0;
  joint.watchdog_s = 0.03;
  return joint;
}

DriveBench Bench(const JointDriveConfig& joint = Joint()) {
  return {std::make_unique<MoteusDrive>(joint),
          std::make_unique<MoteusEmulator>(joint, EmulatedDriveConfig{}, 1)};
}
MoteusEmulator& Emulator(DriveBench& bench) {
  return static_cast<MoteusEmulator&>(*bench.drive);
}
moteus::State Query(DriveBench& bench) {
  bench.Send(moteus::EncodeStateQuery(Joint()));
  moteus::State state;
  EXPECT_EQ(bench.received.size(), 1u);
  EXPECT_TRUE(moteus::DecodeState(bench.received[0], &state));
  return state;
}
CanFrame AnswerToStateQuery() {
  MoteusEmulator drive(Joint(), EmulatedDriveConfig{}, 1);
  FrameList out;
  drive.OnFrame(1.0, moteus::EncodeStateQuery(Joint()), {}, &out);
  return out[0];
}

TEST(MoteusDrive, IsBroughtUpQuicklyWithFewFramesAndNoHeap) {
  DriveBench bench = Bench();
  EXPECT_EQ(bench.master->state(), DriveState::kUnknown);
  int ticks = 0;
  {
    const LimitMalloc guard;
    while (bench.master->state() != DriveState::kTorque && ticks < kMaxTicks) {
      EXPECT_EQ(bench.drive->Torque(bench.t_s), 0.0);
      bench.BringUp();
      ++ticks;
      EXPECT_LE(bench.sent.size(), 2u);
    }
  }
  EXPECT_LE(ticks, 5) << "50 ms";
  EXPECT_EQ(bench.master->watchdog(), DriveWatchdog::kProved);
  EXPECT_EQ(bench.master->Explain(), "");
  EXPECT_TRUE(bench.drive->ProducesTorque());
}

TEST(MoteusDrive, StaysFedUntilTheFirstTorque) {
  DriveBench bench = Bench();
  ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  for (int tick = 0; tick < 100; ++tick) bench.BringUp();
  EXPECT_EQ(bench.master->state(), DriveState::kTorque);
  EXPECT_TRUE(bench.drive->ProducesTorque());
}

TEST(MoteusDrive, TorqueAndStateGoThroughGearDirectionAndOffset) {
  DriveBench bench = Bench();
  bench.truth = {0.8, -1.5};
  ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  for (const double tau_Nm : {7.0, -3.3, 0.001}) {
    bench.Command(tau_Nm);
    EXPECT_FLOAT_EQ(static_cast<float>(bench.drive->Torque(bench.t_s)), static_cast<float>(tau_Nm));
  }
  EXPECT_EQ(bench.sent.size(), 2u) << "a query and a torque";
  EXPECT_NEAR(bench.master->sample().position_rad, 0.8, 1e-7);
  EXPECT_NEAR(bench.master->sample().velocity_rad_s, -1.5, 1e-6);
  EXPECT_FLOAT_EQ(Query(bench).torque_Nm, -0.0005f) << "the moteus's side";
}

TEST(MoteusDrive, IsNeverSentMoreThanItsLimitNorWhatIsNotFinite) {
  DriveBench bench = Bench();
  ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  bench.Command(1e9);
  EXPECT_EQ(bench.drive->Torque(bench.t_s), 12.0);
  bench.Command(-1e9);
  EXPECT_EQ(bench.drive->Torque(bench.t_s), -12.0);
  for (const double bad : {std::nan(""), kInfinity, -kInfinity}) {
    bench.Command(5.0);
    bench.Command(bad);
    EXPECT_EQ(bench.drive->Torque(bench.t_s), 0.0);
  }
}

TEST(MoteusDrive, NothingThatArmsIsSentBeforeTorqueModeNorAfter) {
  DriveBench bench = Bench();
  FrameList out;
  bench.master->CommandTorque(3.0, &out);
  EXPECT_EQ(out.size(), 0u);
  ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  bench.master->CommandTorque(3.0, &out);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_TRUE(out[0].latest_only);
  out.Clear();
  bench.master->Disable(&out);
  bench.master->CommandTorque(3.0, &out);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_EQ(Describe(out[0]), Describe(moteus::EncodeStop(Joint())));
}

TEST(MoteusDrive, ADriveFoundAtTorqueIsStoppedFirst) {
  DriveBench bench = Bench();
  for (int i = 0; i < 3; ++i) {
    bench.Send(moteus::EncodeTorque(Joint(), 4.0f));
    bench.Wait(0.01);
  }
  ASSERT_EQ(bench.drive->Torque(bench.t_s), -8.0);
  bench.BringUp();
  EXPECT_EQ(bench.drive->Torque(bench.t_s), 0.0);
  EXPECT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
}

TEST(MoteusDrive, IsBroughtUpThroughLostFrames) {
  JointDriveConfig joint = Joint();
  joint.watchdog_s = 0.1;  // longer than any run of lost torques
  for (unsigned seed = 0; seed < 50; ++seed) {
    DriveBench bench = Bench(joint);
    std::mt19937 random(seed);
    bench.lost = [&](const CanFrame&) { return random() % 4 == 0; };
    EXPECT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks) << seed;
    bench.lost = [](const CanFrame&) { return false; };
    bench.Command(4.0);
    EXPECT_EQ(bench.drive->Torque(bench.t_s), 4.0) << seed;
  }
}

TEST(MoteusDrive, ASilentDriveStaysUnknownAndIsNamed) {
  DriveBench bench = Bench();
  bench.lost = [](const CanFrame&) { return true; };
  EXPECT_EQ(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  EXPECT_EQ(bench.master->state(), DriveState::kUnknown);
  EXPECT_EQ(bench.master->Explain(), "no answer of servo 5");
}

TEST(MoteusDrive, SilenceLeadsToADampedTimeOutUntilItIsStopped) {
  DriveBench bench = Bench();
  ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  bench.Command(6.0);
  const double last_s = bench.t_s - DriveBench::kPeriod_s + 2 * DriveBench::kFrame_s;
  EXPECT_NEAR(bench.drive->NextTorqueChange(bench.t_s), last_s + 0.03, 1e-6);
  EXPECT_EQ(bench.drive->Torque(last_s + 0.0299), 6.0);
  bench.truth.velocity_rad_s = 10.0;
  bench.Wait(0.03);
  const double motor_turns_s = 10.0 * 2.0 / (2.0 * std::numbers::pi);
  EXPECT_NEAR(bench.drive->Torque(bench.t_s), -2.0 * 0.05 * motor_turns_s, 1e-9) << "against the motion";
  bench.truth.velocity_rad_s = 1000.0;
  bench.Wait(0.002);
  EXPECT_EQ(bench.drive->Torque(bench.t_s), -2.0 * MoteusEmulator::kTimeoutMaxTorque_Nm);
  EXPECT_FALSE(bench.drive->ProducesTorque()) << "it does not follow commands";
  bench.truth.velocity_rad_s = 0.0;
  bench.Command(6.0);
  EXPECT_EQ(Query(bench).mode, Mode::kPositionTimeout) << "latched";
  EXPECT_EQ(bench.master->state(), DriveState::kFault);
  EXPECT_EQ(bench.master->error_code(), 11u);
  EXPECT_EQ(bench.master->Explain(), "its watchdog has tripped (mode 11)");
  EXPECT_EQ(bench.BringUpTicks(20), 20);
  EXPECT_FALSE(bench.drive->ProducesTorque());
  bench.master->Reset();
  EXPECT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks) << "the stop ends it";
}

TEST(MoteusDrive, QueriesDoNotFeedTheWatchdog) {
  DriveBench bench = Bench();
  ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  for (int i = 0; i < 10; ++i) {
    Query(bench);
    bench.Wait(0.005);
  }
  EXPECT_EQ(Query(bench).mode, Mode::kPositionTimeout);
}

TEST(MoteusDrive, AFaultEndsTorqueModeAndIsNamed) {
  DriveBench bench = Bench();
  ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  Emulator(bench).Fail(33);
  bench.Command(6.0);
  EXPECT_EQ(bench.drive->Torque(bench.t_s), 0.0);
  EXPECT_EQ(bench.master->state(), DriveState::kFault);
  EXPECT_EQ(bench.master->error_code(), 33u);
  EXPECT_EQ(bench.master->Explain(), "motor driver fault (fault 33)");
  EXPECT_EQ(bench.BringUpTicks(20), 20);
  EXPECT_FALSE(bench.drive->ProducesTorque());
}

TEST(MoteusDrive, AnOldFaultIsClearedAndOneThatComesBackGivenUp) {
  DriveBench bench = Bench();
  Emulator(bench).Fail(38);
  ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  DriveBench failing = Bench();
  int ticks = 0;
  for (; failing.master->state() != DriveState::kFault && ticks < kMaxTicks; ++ticks) {
    failing.BringUp();
    if (failing.drive->NextEvent(failing.t_s) < 1e9) Emulator(failing).Fail(40);  // whenever it is enabled
  }
  EXPECT_LT(ticks, kMaxTicks);
  EXPECT_EQ(failing.master->Explain(), "under voltage (fault 40)");
}

TEST(MoteusDrive, AFunctionThatLimitsThePowerIsNoFault) {
  DriveBench bench = Bench();
  ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  CanFrame frame = AnswerToStateQuery();
  frame.data[2] = 10;
  frame.data[19] = 99;  // servo.max_current_A
  EXPECT_EQ(bench.master->OnFrame(frame), Reception::kTaken);
  EXPECT_EQ(bench.master->state(), DriveState::kTorque);
  EXPECT_EQ(bench.master->error_code(), 0u);
}

TEST(MoteusDrive, AnotherRegisterMapOrWatchdogIsRefused) {
  const auto refusal = [](size_t byte, uint8_t value, Mode mode) {
    MoteusDrive drive(Joint());
    MoteusEmulator emulated(Joint(), EmulatedDriveConfig{}, 1);
    FrameList out;
    for (double t_s = 1.0; t_s < 1.2; t_s += 0.01) {
      FrameList sent;
      drive.BringUp(std::llround(1e9 * t_s), &sent);
      for (const CanFrame& frame : sent) {
        out.Clear();
        emulated.OnFrame(t_s, frame, {}, &out);
        for (CanFrame answer : out) {
          if (answer.data[2] == static_cast<uint8_t>(mode)) answer.data[byte] = value;
          drive.OnFrame(answer);
        }
      }
    }
    EXPECT_EQ(drive.state(), DriveState::kFault);
    return drive.Explain();
  };
  EXPECT_EQ(refusal(29, 4, Mode::kStopped), "its register map has version 4, known is 5");
  EXPECT_EQ(refusal(25, 0x40, Mode::kPosition).substr(0, 28), "its watchdog reads back as 7");
}

TEST(MoteusDrive, NonsenseIsMalformedAndOthersFramesAreNotItsOwn) {
  DriveBench bench = Bench();
  ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  const CanFrame good = AnswerToStateQuery();
  const uint64_t sequence = bench.master->sample().sequence;
  const auto reception = [&](auto change) {
    CanFrame frame = good;
    change(frame);
    return bench.master->OnFrame(frame);
  };
  EXPECT_EQ(reception([](CanFrame& frame) { frame.data[0] = 0x31; }), Reception::kMalformed);
  EXPECT_EQ(reception([](CanFrame& frame) { frame.length = 0; }), Reception::kMalformed);
  EXPECT_EQ(reception([](CanFrame& frame) { frame.fd = false, frame.length = 8; }), Reception::kMalformed);
  EXPECT_EQ(reception([](CanFrame& frame) { frame.data[8] = frame.data[7] = 0xFF; }), Reception::kMalformed);
  EXPECT_EQ(reception([](CanFrame& frame) { frame.id = 0x0600; }), Reception::kNotMine);
  EXPECT_EQ(reception([](CanFrame& frame) { frame.error = true; }), Reception::kNotMine);
  EXPECT_EQ(bench.master->OnFrame(moteus::EncodeTorque(Joint(), 1.0f)), Reception::kNotMine) << "our own";
  EXPECT_EQ(bench.master->sample().sequence, sequence);
  EXPECT_EQ(bench.master->state(), DriveState::kTorque);
}

TEST(MoteusDrive, SurvivesAnyFrame) {
  DriveBench bench = Bench();
  std::mt19937_64 random(9);
  FrameList out;
  for (int i = 0; i < 200'000; ++i) {
    CanFrame frame = RandomFrame(&random);
    if (random() % 2 == 0) {
      const uint32_t ids[] = {0x0500, 0x8005, 0x0005, 0x8105};
      frame.id = ids[random() % 4];
      frame.extended = true;
    }
    bench.master->OnFrame(frame);
    out.Clear();
    bench.drive->OnFrame(1.0 + 1e-6 * i, frame, {0.1, 0.2}, &out);
    EXPECT_TRUE(std::isfinite(bench.master->sample().position_rad));
    EXPECT_LE(std::abs(bench.drive->Torque(1.0 + 1e-6 * i)), 12.0);
    for (const CanFrame& answer : out) ASSERT_TRUE(IsValid(answer));
  }
}

TEST(MoteusDrive, FiltersLetItsOwnFramesPassAndNoOthers) {
  const std::vector<CanFilter> filters = MoteusDrive(Joint()).Filters();
  const auto passes = [&](const CanFrame& frame) {
    return std::any_of(filters.begin(), filters.end(),
                       [&](const CanFilter& filter) { return Passes(filter, frame); });
  };
  EXPECT_TRUE(passes(moteus::EncodeStop(Joint())));
  EXPECT_TRUE(passes(moteus::EncodeStateQuery(Joint())));
  EXPECT_TRUE(passes(moteus::EmptyFrame(0x0500)));
  CanFrame extended = moteus::EmptyFrame(0x0500);
  extended.extended = true;
  EXPECT_TRUE(passes(extended)) << "up to 0x7FF the manual allows both";
  EXPECT_FALSE(passes(moteus::EmptyFrame(0x0600)));
  EXPECT_FALSE(passes(moteus::EmptyFrame(0x8006)));
}

}  // namespace
}  // namespace armada
