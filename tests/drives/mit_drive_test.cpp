#include "firmware/can/mit_drive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "hil/mit_emulator.h"
#include "tests/can/frames.h"
#include "tests/drives/drive_bench.h"
#include "tests/support/limit_malloc.h"

namespace armada {
namespace {

using mit::Special;

constexpr int kMaxTicks = 80;  // 0.8 s

JointDriveConfig Joint(DriveProfile profile) {
  JointDriveConfig joint;
  joint.profile = profile;
  joint.node_id = 3;
  joint.gear_ratio = 2.0;
  joint.direction = -1.0;
  joint.offset_rad = 0.5;
  joint.torque_limit_Nm = 20.0;
  joint.watchdog_s = 0.03;
  joint.mit.master_id = 0x70;
  return joint;
}

DriveBench Bench(const JointDriveConfig& master, const JointDriveConfig& drive) {
  EmulatedDriveConfig config;
  config.latency_s = 0.001;
  config.watchdog_s = 0.025;
  return {std::make_unique<MitDrive>(master), std::make_unique<MitEmulator>(drive, config, 1)};
}
DriveBench Bench(DriveProfile profile) {
  return Bench(Joint(profile), Joint(profile));
}
MitEmulator& Emulator(DriveBench& bench) {
  return static_cast<MitEmulator&>(*bench.drive);
}

/// Joint torque of one code, and of the code for zero.
double Step_Nm(const JointDriveConfig& joint) {
  return mit::TorqueStep_Nm(joint.mit) * joint.gear_ratio;
}

class MitDrives : public testing::TestWithParam<DriveProfile> {};
INSTANTIATE_TEST_SUITE_P(Profiles, MitDrives,
                         testing::Values(DriveProfile::kMiniCheetah, DriveProfile::kCubeMars,
                                         DriveProfile::kDamiao),
                         [](const auto& profile) {
                           return profile.param == DriveProfile::kMiniCheetah ? "MiniCheetah"
                                  : profile.param == DriveProfile::kCubeMars  ? "CubeMars"
                                                                              : "Damiao";
                         });

TEST_P(MitDrives, AreBroughtUpQuicklyWithFewFramesAndNoHeap) {
  DriveBench bench = Bench(GetParam());
  EXPECT_EQ(bench.master->state(), DriveState::kUnknown);
  int ticks = 0;
  {
    const LimitMalloc guard;
    while (bench.master->state() != DriveState::kTorque && ticks < kMaxTicks) {
      bench.BringUp();
      ++ticks;
      EXPECT_LE(bench.sent.size(), 3u);
    }
  }
  EXPECT_EQ(ticks, GetParam() == DriveProfile::kDamiao ? 10 : 6);
  EXPECT_EQ(bench.master->state(), DriveState::kTorque);
  EXPECT_EQ(bench.master->Explain(), "");
  EXPECT_TRUE(bench.drive->ProducesTorque());
  EXPECT_EQ(bench.master->error_code(), 0u);
}

TEST_P(MitDrives, StayFedUntilTheFirstTorque) {
  DriveBench bench = Bench(GetParam());
  ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  for (int tick = 0; tick < 100; ++tick) bench.BringUp();
  EXPECT_EQ(bench.master->state(), DriveState::kTorque);
  EXPECT_TRUE(bench.drive->ProducesTorque());
}

TEST_P(MitDrives, TorqueAndStateGoThroughGearDirectionAndOffset) {
  DriveBench bench = Bench(GetParam());
  bench.truth = {0.8, -1.5};
  ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  const JointDriveConfig joint = Joint(GetParam());
  for (const double tau_Nm : {7.0, -3.3, 0.25}) {
    bench.Command(tau_Nm);
    EXPECT_NEAR(bench.drive->Torque(bench.t_s), tau_Nm, 0.51 * Step_Nm(joint));
  }
  EXPECT_NEAR(bench.master->sample().position_rad, 0.8, 25.0 / 65535.0 / 2.0);
  EXPECT_NEAR(bench.master->sample().velocity_rad_s, -1.5, 90.0 / 4095.0 / 2.0);
}

TEST_P(MitDrives, AreNeverSentMoreThanTheirLimit) {
  DriveBench bench = Bench(GetParam());
  ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  for (const double tau_Nm : {1e9, 20.0, -20.0, -1e9}) {
    bench.Command(tau_Nm);
    const mit::Command command = mit::DecodeCommand(bench.sent[1], Joint(GetParam()));
    EXPECT_LE(std::abs(command.torque_Nm), 10.0);
    EXPECT_GT(std::abs(command.torque_Nm), 9.99) << "limit at the joint 20, gear 2";
    EXPECT_EQ(command.kp_Nm_rad, 0.0);
    EXPECT_EQ(command.kd_Nms_rad, 0.0);
  }
}

TEST_P(MitDrives, TorqueThatIsNotFiniteIsZero) {
  DriveBench bench = Bench(GetParam());
  ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double bad : {std::nan(""), kInfinity, -kInfinity}) {
    bench.Command(5.0);
    bench.Command(bad);
    EXPECT_NEAR(bench.drive->Torque(bench.t_s), 0.0, 0.51 * Step_Nm(Joint(GetParam())));
  }
}

TEST_P(MitDrives, ASampleIsAsFreshAsTheTick) {
  DriveBench bench = Bench(GetParam());
  ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  bench.Command(5.0);
  bench.truth.position_rad = 1.0;
  const uint64_t sequence = bench.master->sample().sequence;
  const double tick_s = bench.t_s;
  FrameList request;
  bench.master->RequestSample(bench.now_ns(), &request);
  ASSERT_EQ(request.size(), 1u);
  EXPECT_EQ(Describe(request[0]), Describe(bench.sent[1])) << "the last torque once more";
  EXPECT_TRUE(request[0].latest_only);
  bench.Command(5.0);
  EXPECT_EQ(bench.master->sample().sequence, sequence + 2);
  EXPECT_NEAR(bench.master->sample().position_rad, 1.0, 1e-3);
  EXPECT_GE(bench.master->sample().stamp_ns, std::llround(1e9 * tick_s));
}

TEST_P(MitDrives, NoTorqueIsSentBeforeTorqueModeNorAfter) {
  DriveBench bench = Bench(GetParam());
  const auto sends_zero = [&] {
    FrameList out;
    bench.master->CommandTorque(8.0, &out);
    return out.size() == 1 &&
           mit::DecodeCommand(out[0], Joint(GetParam())).torque_Nm < 0.0 &&  // half a step below zero
           Describe(out[0]) == Describe(mit::EncodeTorque(Joint(GetParam()), mit::kZeroTorqueCode));
  };
  while (bench.master->state() != DriveState::kTorque) {
    EXPECT_TRUE(sends_zero());
    bench.BringUp();
    ASSERT_LT(bench.t_s, 2.0);
  }
  EXPECT_FALSE(sends_zero());
  FrameList out;
  bench.master->Disable(&out);
  EXPECT_TRUE(sends_zero());
}

TEST_P(MitDrives, AnOldCommandInTheDriveIsZeroedBeforeItIsEnabled) {
  DriveBench bench = Bench(GetParam());
  const JointDriveConfig joint = Joint(GetParam());
  bench.Send(mit::EncodeTorque(joint, 0xFFF));  // kept by a drive that is not enabled
  while (bench.master->state() != DriveState::kTorque) {
    bench.BringUp();
    EXPECT_LE(std::abs(bench.drive->Torque(bench.t_s)), 0.51 * Step_Nm(joint));
    ASSERT_LT(bench.t_s, 2.0);
  }
}

TEST_P(MitDrives, ADriveFoundEnabledAndAtTorqueIsSwitchedOffFirst) {
  DriveBench bench = Bench(GetParam());
  const JointDriveConfig joint = Joint(GetParam());
  bench.Send(mit::EncodeSpecial(joint, Special::kEnable));
  bench.Send(mit::EncodeTorque(joint, 0xFFF));
  bench.Wait(0.002);
  ASSERT_GT(std::abs(bench.drive->Torque(bench.t_s)), 10.0);
  bench.BringUp();
  EXPECT_EQ(bench.drive->Torque(bench.t_s), 0.0);
  EXPECT_FALSE(bench.drive->ProducesTorque());
  EXPECT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
}

TEST_P(MitDrives, AreBroughtUpThroughLostFrames) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    DriveBench bench = Bench(GetParam());
    std::mt19937 random(seed);
    bench.lost = [&](const CanFrame&) { return random() % 4 == 0; };
    EXPECT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks) << seed;
    bench.lost = [](const CanFrame&) { return false; };
    bench.Command(4.0);
    EXPECT_NEAR(bench.drive->Torque(bench.t_s), 4.0, 0.51 * Step_Nm(Joint(GetParam()))) << seed;
  }
}

TEST_P(MitDrives, ASilentDriveStaysUnknownAndIsNamed) {
  DriveBench bench = Bench(GetParam());
  bench.lost = [](const CanFrame&) { return true; };
  EXPECT_EQ(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  EXPECT_EQ(bench.master->state(), DriveState::kUnknown);
  EXPECT_EQ(bench.master->Explain(), "no answer on identifier 0x070 with node 3 in it");
}

TEST_P(MitDrives, AStoppedDriveIsOffAndIsNotArmedAgainUntilReset) {
  for (const bool quick : {false, true}) {
    DriveBench bench = Bench(GetParam());
    ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
    bench.Command(9.0);
    FrameList out;
    quick ? bench.master->QuickStop(&out) : bench.master->Disable(&out);
    ASSERT_EQ(out.size(), 2u);
    EXPECT_EQ(out[0].data[7], 0xFF) << "zero torque";
    EXPECT_EQ(out[1].data[7], 0xFD);
    EXPECT_FALSE(out[1].latest_only);
    bench.Send(out[0]);
    bench.Send(out[1]);
    EXPECT_EQ(bench.drive->Torque(bench.t_s), 0.0);
    EXPECT_EQ(bench.BringUpTicks(kMaxTicks), kMaxTicks);
    EXPECT_FALSE(bench.drive->ProducesTorque());
    EXPECT_EQ(bench.master->state(), DriveState::kIdle);
    EXPECT_EQ(bench.master->Explain(), "switched off");
    bench.master->Reset();
    EXPECT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  }
}

TEST_P(MitDrives, NonsenseIsMalformedAndOthersFramesAreNotTheirs) {
  DriveBench bench = Bench(GetParam());
  ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  const JointDriveConfig joint = Joint(GetParam());
  const CanFrame good = mit::EncodeReply(joint, {.position_rad = -1.0, .status = 0});
  const JointSample before = bench.master->sample();
  const auto reception = [&](auto change) {
    CanFrame frame = good;
    change(frame);
    return bench.master->OnFrame(frame);
  };
  EXPECT_EQ(reception([](CanFrame& frame) { frame.length = 5; }), Reception::kMalformed);
  EXPECT_EQ(reception([](CanFrame& frame) { frame.data[1] = 0xFF; }), Reception::kMalformed) << "upper end";
  EXPECT_EQ(reception([](CanFrame& frame) { frame.data[1] = frame.data[2] = 0; }), Reception::kMalformed);
  EXPECT_EQ(reception([](CanFrame& frame) { frame.data[0] ^= 1; }), Reception::kNotMine);
  EXPECT_EQ(reception([](CanFrame& frame) { frame.id = 0x71; }), Reception::kNotMine);
  EXPECT_EQ(reception([](CanFrame& frame) { frame.length = 0; }), Reception::kNotMine);
  EXPECT_EQ(reception([](CanFrame& frame) { frame.extended = true; }), Reception::kNotMine);
  EXPECT_EQ(bench.master->OnFrame(mit::EncodeTorque(joint, 0)), Reception::kNotMine) << "our own";
  EXPECT_EQ(bench.master->sample().sequence, before.sequence);
  EXPECT_EQ(bench.master->state(), DriveState::kTorque);
}

TEST_P(MitDrives, APositionThatLeapsToTheOtherEndIsNotBelieved) {
  DriveBench bench = Bench(GetParam());
  bench.truth.position_rad = 0.5 - 12.3 / 2.0;  // motor at 12.3 of 12.5 rad
  ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  const uint64_t sequence = bench.master->sample().sequence;
  for (int tick = 0; tick < 10; ++tick) {
    bench.truth.position_rad = 0.5 - (12.8 + 0.2 * tick) / 2.0;  // beyond: packed as -12.2 and up
    bench.Command(0.0);
  }
  EXPECT_EQ(bench.master->sample().sequence, sequence) << "no sample rather than a wrong one";
}

TEST_P(MitDrives, SurviveAnyFrame) {
  DriveBench bench = Bench(GetParam());
  std::mt19937_64 random(9);
  FrameList out;
  for (int i = 0; i < 200'000; ++i) {
    CanFrame frame = RandomFrame(&random);
    if (random() % 2 == 0) {
      const uint32_t ids[] = {0x70, 3, 0x7FF};
      frame.id = ids[random() % 3];
      frame.extended = false;
    }
    bench.master->OnFrame(frame);
    out.Clear();
    bench.drive->OnFrame(1.0 + 1e-6 * i, frame, {0.1, 0.2}, &out);
    EXPECT_TRUE(std::isfinite(bench.master->sample().position_rad));
    EXPECT_LE(std::abs(bench.drive->Torque(1.0 + 1e-6 * i)), 20.0);
    for (const CanFrame& answer : out) ASSERT_TRUE(IsValid(answer));
  }
}

TEST_P(MitDrives, FiltersLetTheirOwnFramesPassAndNoOthers) {
  DriveBench bench = Bench(GetParam());
  const std::vector<CanFilter> filters = bench.master->Filters();
  const auto passes = [&](uint32_t id) {
    return std::any_of(filters.begin(), filters.end(),
                       [&](const CanFilter& filter) { return Passes(filter, DataFrame(id, {})); });
  };
  EXPECT_TRUE(passes(3));
  EXPECT_TRUE(passes(0x70));
  EXPECT_EQ(passes(0x7FF), GetParam() == DriveProfile::kDamiao);
  EXPECT_FALSE(passes(4));
}

TEST_P(MitDrives, SettingsThatCannotWorkAreRefusedByName) {
  JointDriveConfig joint = Joint(GetParam());
  joint.torque_limit_Nm = 0.005;
  MitDrive limit(joint);
  FrameList out;
  limit.BringUp(0, &out);
  EXPECT_EQ(out.size(), 0u);
  EXPECT_EQ(limit.state(), DriveState::kFault);
  EXPECT_EQ(limit.Explain(),
            "torque_limit_Nm is 0.0025 N m at the motor, below half a step (0.0043956 N m) of torque_max_Nm");
  joint = Joint(GetParam());
  joint.mit.master_id = 3;
  MitDrive address(joint);
  address.BringUp(0, &out);
  EXPECT_EQ(address.state(), DriveState::kFault);
  EXPECT_EQ(address.Explain(), "master_id and node_id are both 3: they must differ");
}

class MitWithoutStatus : public MitDrives {};
INSTANTIATE_TEST_SUITE_P(Profiles, MitWithoutStatus,
                         testing::Values(DriveProfile::kMiniCheetah, DriveProfile::kCubeMars));

TEST_P(MitWithoutStatus, SilenceZeroesTheCommandUntilTheNextOne) {
  DriveBench bench = Bench(GetParam());
  ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  EXPECT_EQ(bench.master->watchdog(), DriveWatchdog::kUnproved) << "nothing on the wire tells";
  bench.Command(6.0);
  const double last_s = bench.t_s - DriveBench::kPeriod_s + 2 * DriveBench::kFrame_s;
  EXPECT_NEAR(bench.drive->NextTorqueChange(bench.t_s), last_s + 0.025, 1e-9);
  EXPECT_NE(bench.drive->Torque(last_s + 0.0249), 0.0);
  EXPECT_EQ(bench.drive->Torque(last_s + 0.0251), 0.0);
  bench.Wait(0.05);
  EXPECT_EQ(bench.drive->Torque(bench.t_s), 0.0);
  EXPECT_TRUE(bench.drive->ProducesTorque()) << "it is still enabled";
  bench.Command(6.0);
  EXPECT_NEAR(bench.drive->Torque(bench.t_s), 6.0, 0.02);
}

TEST_P(MitWithoutStatus, SpecialFramesDoNotFeed) {
  DriveBench bench = Bench(GetParam());
  ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  bench.Command(6.0);
  for (int i = 0; i < 4; ++i) {
    bench.Send(mit::EncodeSpecial(Joint(GetParam()), Special::kEnable));
    EXPECT_EQ(bench.received.size(), 1u) << "answered all the same";
    bench.Wait(0.006);
  }
  EXPECT_EQ(bench.drive->Torque(bench.t_s), 0.0);
}

TEST(CubeMars, AnErrorEndsTorqueModeAndIsNamed) {
  DriveBench bench = Bench(DriveProfile::kCubeMars);
  ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  bench.Command(6.0);
  Emulator(bench).Fail(2);
  bench.Command(6.0);
  EXPECT_EQ(bench.master->state(), DriveState::kFault);
  EXPECT_EQ(bench.master->error_code(), 2u);
  EXPECT_EQ(bench.master->Explain(), "over current (error 0x2)");
  Emulator(bench).Fail(0);
  EXPECT_EQ(bench.BringUpTicks(20), 20) << "the cause is gone, nobody has decided";
  EXPECT_FALSE(bench.drive->ProducesTorque());
  bench.master->Reset();
  EXPECT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
}

}  // namespace
}  // namespace armada
