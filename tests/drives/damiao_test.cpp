#include <gtest/gtest.h>

#include <bit>

#include "firmware/can/damiao_messages.h"
#include "firmware/can/mit_drive.h"
#include "hil/mit_emulator.h"
#include "tests/can/frames.h"
#include "tests/drives/drive_bench.h"

namespace armada {
namespace {

using damiao::Access;
using damiao::Register;

constexpr int kMaxTicks = 80;

JointDriveConfig Joint() {
  JointDriveConfig joint;
  joint.profile = DriveProfile::kDamiao;
  joint.node_id = 1;
  joint.torque_limit_Nm = 7.0;
  joint.watchdog_s = 0.03;
  joint.mit.master_id = 0x11;
  joint.mit.velocity_max_rad_s = 30.0;
  joint.mit.torque_max_Nm = 10.0;
  return joint;
}

DriveBench Bench(const JointDriveConfig& drive = Joint()) {
  return {std::make_unique<MitDrive>(Joint()),
          std::make_unique<MitEmulator>(drive, EmulatedDriveConfig{}, 1)};
}
MitEmulator& Emulator(DriveBench& bench) {
  return static_cast<MitEmulator&>(*bench.drive);
}
uint32_t ReadBack(DriveBench& bench, Register reg) {
  bench.Send(damiao::EncodeRequest(Joint(), {Access::kRead, reg, 0}));
  damiao::RegisterAccess answer;
  EXPECT_EQ(bench.received.size(), 1u);
  EXPECT_TRUE(damiao::DecodeAnswer(bench.received[0], Joint(), &answer));
  return answer.raw;
}

// Bytes by Damiao's driver DM_CAN: {id low, id high, 0x33 or 0x55, register, value little-endian} on 0x7FF,
// answered on the master id with the same first four bytes. 12.5 is the float 0x41480000.
TEST(DamiaoMessages, RegisterFramesHaveTheBytesOfTheVendorsDriver) {
  const JointDriveConfig joint = Joint();
  EXPECT_EQ(Describe(damiao::EncodeRequest(joint, {Access::kRead, Register::kPositionMax, 0})),
            Describe(DataFrame(0x7FF, {0x01, 0x00, 0x33, 0x15, 0x00, 0x00, 0x00, 0x00})));
  EXPECT_EQ(Describe(damiao::EncodeRequest(joint, {Access::kWrite, Register::kControlMode, 1})),
            Describe(DataFrame(0x7FF, {0x01, 0x00, 0x55, 0x0A, 0x01, 0x00, 0x00, 0x00})));
  damiao::RegisterAccess answer;
  ASSERT_TRUE(damiao::DecodeAnswer(DataFrame(0x11, {0x01, 0x00, 0x33, 0x15, 0x00, 0x00, 0x48, 0x41}), joint,
                                   &answer));
  EXPECT_EQ(answer.reg, Register::kPositionMax);
  EXPECT_EQ(std::bit_cast<float>(answer.raw), 12.5f);
}

TEST(DamiaoMessages, AnAnswerIsNeitherAnothersNorAState) {
  const JointDriveConfig joint = Joint();
  damiao::RegisterAccess answer;
  EXPECT_FALSE(damiao::DecodeAnswer(DataFrame(0x11, {0x02, 0, 0x33, 0x15, 0, 0, 0, 0}), joint, &answer));
  EXPECT_FALSE(damiao::DecodeAnswer(DataFrame(0x12, {0x01, 0, 0x33, 0x15, 0, 0, 0, 0}), joint, &answer));
  EXPECT_FALSE(damiao::DecodeAnswer(DataFrame(0x11, {0x01, 0, 0x33, 0x15}), joint, &answer));
  // Every state whose position is worth anything, and whatever else is in it.
  for (uint32_t code = mit::kPositionMargin; code <= 0xFFFF - mit::kPositionMargin; ++code) {
    const CanFrame state = DataFrame(
        0x11, {0x01, static_cast<uint8_t>(code >> 8), static_cast<uint8_t>(code), 0x15, 0, 0, 0, 0});
    ASSERT_FALSE(damiao::DecodeAnswer(state, joint, &answer)) << code;
  }
}

TEST(DamiaoDrive, ItsTimeOutIsWrittenAndReadBack) {
  DriveBench bench = Bench();
  EXPECT_EQ(ReadBack(bench, Register::kTimeout), 0u) << "off, as delivered";
  ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  EXPECT_EQ(bench.master->watchdog(), DriveWatchdog::kProved);
  EXPECT_EQ(ReadBack(bench, Register::kTimeout), 600u) << "30 ms in units of 50 us";
}

TEST(DamiaoDrive, SilenceDisablesItUntilSomebodyDecides) {
  DriveBench bench = Bench();
  ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  bench.Command(5.0);
  bench.Wait(0.03);
  EXPECT_EQ(bench.drive->Torque(bench.t_s), 0.0);
  EXPECT_FALSE(bench.drive->ProducesTorque());
  bench.Command(5.0);
  EXPECT_EQ(bench.drive->Torque(bench.t_s), 0.0);
  EXPECT_EQ(bench.master->state(), DriveState::kFault);
  EXPECT_EQ(bench.master->error_code(), 0xDu);
  EXPECT_EQ(bench.master->Explain(), "communication lost (status 0xd)");
  EXPECT_EQ(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  EXPECT_FALSE(bench.drive->ProducesTorque());
  bench.master->Reset();
  EXPECT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks) << "an old fault is cleared";
}

TEST(DamiaoDrive, EveryFrameToItFeedsIt) {
  DriveBench bench = Bench();
  ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  for (int i = 0; i < 10; ++i) {
    bench.Wait(0.015);
    bench.Send(mit::EncodeSpecial(Joint(), mit::Special::kEnable));
  }
  EXPECT_TRUE(bench.drive->ProducesTorque());
}

TEST(DamiaoDrive, ADriveInAnotherModeIsPutIntoMit) {
  DriveBench bench = Bench();
  bench.Send(damiao::EncodeRequest(Joint(), {Access::kWrite, Register::kControlMode, 2}));
  ASSERT_EQ(ReadBack(bench, Register::kControlMode), 2u);
  ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  EXPECT_EQ(ReadBack(bench, Register::kControlMode), damiao::kMitMode);
  bench.Command(5.0);
  EXPECT_NEAR(bench.drive->Torque(bench.t_s), 5.0, 0.003);
}

TEST(DamiaoDrive, RangesThatDifferAreRefusedWithBothValues) {
  struct Case {
    double MitConfig::*range;
    const char* explanation;
  };
  for (const Case& c : {Case{&MitConfig::position_max_rad,
                             "PMAX (register 21) of the drive is 3.1415, the fleet file says 12.5"},
                        Case{&MitConfig::velocity_max_rad_s,
                             "VMAX (register 22) of the drive is 3.1415, the fleet file says 30"},
                        Case{&MitConfig::torque_max_Nm,
                             "TMAX (register 23) of the drive is 3.1415, the fleet file says 10"}}) {
    JointDriveConfig drive = Joint();
    drive.mit.*c.range = 3.1415;
    DriveBench bench = Bench(drive);
    EXPECT_EQ(bench.BringUpTicks(kMaxTicks), kMaxTicks);
    EXPECT_EQ(bench.master->state(), DriveState::kFault);
    EXPECT_EQ(bench.master->Explain().substr(0, 40), std::string(c.explanation).substr(0, 40));
    EXPECT_EQ(bench.master->watchdog(), DriveWatchdog::kUnproved);
    EXPECT_FALSE(bench.drive->ProducesTorque());
  }
}

TEST(DamiaoDrive, ARegisterThatDoesNotTakeItsValueIsRefused) {
  DriveBench bench = Bench();
  int writes = 0;
  bench.lost = [&](const CanFrame& frame) {
    const bool write = frame.id == 0x7FF && frame.data[2] == 0x55;
    writes += write;
    return write;
  };
  EXPECT_EQ(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  EXPECT_EQ(bench.master->state(), DriveState::kFault);
  EXPECT_EQ(bench.master->Explain(), "TIMEOUT (register 9) of the drive is 0, written was 600");
  EXPECT_EQ(writes, JointDriveConfig().bring_up_attempts);
}

TEST(DamiaoDrive, AFaultIsNamedAndAnOldOneCleared) {
  DriveBench bench = Bench();
  Emulator(bench).Fail(0x9);
  ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks) << "from before";
  Emulator(bench).Fail(0xC);
  bench.Command(1.0);
  EXPECT_EQ(bench.master->state(), DriveState::kFault);
  EXPECT_EQ(bench.master->Explain(), "over temperature of the rotor (status 0xc)");
}

TEST(DamiaoDrive, AFaultInTheMidstOfABringUpIsClearedAndAllIsSetUpAnew) {
  for (int ticks = 1; ticks < 10; ++ticks) {
    DriveBench bench = Bench();
    bench.BringUpTicks(ticks);
    Emulator(bench).Fail(0x8);
    EXPECT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks)
        << "after " << ticks << " ticks: " << bench.master->Explain();
    EXPECT_EQ(bench.master->watchdog(), DriveWatchdog::kProved);
  }
}

TEST(DamiaoDrive, AFaultThatComesBackIsGivenUp) {
  DriveBench bench = Bench();
  for (int tick = 0; tick < kMaxTicks; ++tick) {
    Emulator(bench).Fail(0x8);
    bench.BringUp();
  }
  Emulator(bench).Fail(0x8);
  EXPECT_EQ(bench.BringUpTicks(2), 2);
  EXPECT_NE(bench.master->state(), DriveState::kTorque);
  EXPECT_FALSE(bench.drive->ProducesTorque());
}

TEST(DamiaoDrive, ADriveThatDisablesItselfIsNotEnabledAgain) {
  DriveBench bench = Bench();
  ASSERT_LT(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  bench.Send(mit::EncodeSpecial(Joint(), mit::Special::kDisable));  // somebody else
  bench.Command(1.0);
  EXPECT_EQ(bench.master->state(), DriveState::kIdle);
  EXPECT_EQ(bench.BringUpTicks(kMaxTicks), kMaxTicks);
  EXPECT_FALSE(bench.drive->ProducesTorque());
}

TEST(DamiaoDrive, ANodeThatAReplyCannotTellIsRefused) {
  JointDriveConfig joint = Joint();
  joint.node_id = 16;
  MitDrive drive(joint);
  FrameList out;
  drive.BringUp(0, &out);
  EXPECT_EQ(drive.Explain(), "node_id is 16, a Damiao reply can tell 0 to 15");
  EXPECT_EQ(drive.state(), DriveState::kFault);
}

TEST(DamiaoDrive, SevenDrivesShareOneReplyIdentifier) {
  std::vector<std::unique_ptr<MitDrive>> masters;
  FrameList answers;
  for (int node = 1; node <= 7; ++node) {
    JointDriveConfig joint = Joint();
    joint.node_id = node;
    masters.push_back(std::make_unique<MitDrive>(joint));
    answers.Push(mit::EncodeReply(joint, {.position_rad = 0.1 * node}));
  }
  for (const CanFrame& answer : answers) {
    for (const auto& master : masters) master->OnFrame(answer);
  }
  for (int node = 1; node <= 7; ++node) {
    EXPECT_EQ(masters[static_cast<size_t>(node - 1)]->sample().sequence, 1u);
    EXPECT_NEAR(masters[static_cast<size_t>(node - 1)]->sample().position_rad, 0.1 * node, 4e-4);
  }
}

}  // namespace
}  // namespace armada
