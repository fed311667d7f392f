#include "firmware/can/cia402_drive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "tests/drives/cia402_bench.h"
#include "tests/drives/cia402_bytes.h"
#include "tests/support/limit_malloc.h"

namespace armada {
namespace {

using cia402::PowerState;
using testing::HasSubstr;

constexpr int kNode = 3;
constexpr int kSecond = 100;  ///< ticks

Cia402Bench Ready() {
  Cia402Bench bench({Cia402Joint(kNode)});
  EXPECT_LE(bench.BringUpTicks(kSecond), kSecond) << bench.masters[0]->Explain();
  return bench;
}

bool IsCommand(const CanFrame& frame) {
  return (frame.id & ~0x7Fu) == 0x200;
}
int16_t TorqueOf(const CanFrame& frame) {
  return static_cast<int16_t>(frame.data[2] | frame.data[3] << 8);
}

// As of a fleet file without a torque limit, which is looked at once more before it is refused.
TEST(Cia402, AnUnknownTorqueLimitAllowsNone) {
  JointDriveConfig joint = Cia402Joint(kNode);
  joint.torque_limit_Nm = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(cia402::MaxTorqueOf(joint), 0);
}

TEST(Cia402, IsUpFromColdInLessThanASecondOfTicks) {
  Cia402Bench bench({Cia402Joint(kNode)});
  EXPECT_EQ(bench.masters[0]->state(), DriveState::kUnknown);
  const int ticks = bench.BringUpTicks(kSecond);
  RecordProperty("ticks", ticks);
  EXPECT_LE(ticks, 85);
  EXPECT_EQ(bench.masters[0]->watchdog(), DriveWatchdog::kProved);
  EXPECT_EQ(bench.masters[0]->Explain(), "");
  EXPECT_TRUE(bench.drives[0]->ProducesTorque());
}

TEST(Cia402, SevenDrivesComeUpTogetherWithinTheFrameListOfATick) {
  std::vector<JointDriveConfig> joints;
  for (int node = 1; node <= 7; ++node) joints.push_back(Cia402Joint(node));
  Cia402Bench bench(joints);
  EXPECT_LE(bench.BringUpTicks(kSecond), 85);
  EXPECT_LE(bench.most_frames_a_tick, 2u * 7u + 2u);
  EXPECT_EQ(bench.malformed, 0);
}

TEST(Cia402, ADriveThatWasInUseIsConfiguredAnew) {
  Cia402Bench bench = Ready();
  for (int i = 0; i < 20; ++i) bench.Command(5.0);
  bench.masters = MakeDrives(std::vector{Cia402Joint(kNode)});
  EXPECT_LE(bench.BringUpTicks(kSecond), kSecond);
  EXPECT_TRUE(bench.drives[0]->ProducesTorque());
}

TEST(Cia402, NoTorqueAndNoEnablingBeforeTorqueMode) {
  Cia402Bench bench({Cia402Joint(kNode)});
  while (bench.masters[0]->state() != DriveState::kTorque && bench.t_s < 1.0) {
    FrameList out;
    bench.masters[0]->CommandTorque(50.0, &out);
    bench.masters[0]->BringUp(bench.now_ns(), &out);
    bench.Exchange(out);
    EXPECT_EQ(bench.drives[0]->Torque(bench.t_s), 0.0);
  }
  EXPECT_EQ(bench.masters[0]->state(), DriveState::kTorque);
  for (const CanFrame& frame : bench.log) {
    ASSERT_TRUE(!IsCommand(frame) || TorqueOf(frame) == 0);
  }
}

// 120 N m at the joint, gear 10, direction -1: -12 N m at the motor, rated 10 N m: -1200 thousandths.
TEST(Cia402, TorqueIsInThousandthsOfTheRatedTorqueAndTowardZero) {
  Cia402Bench bench = Ready();
  const auto sent = [&](double tau_Nm) {
    FrameList out;
    bench.masters[0]->CommandTorque(tau_Nm, &out);
    EXPECT_EQ(out.size(), 1u);
    EXPECT_TRUE(out[0].latest_only);
    return Text(out[0]);
  };
  EXPECT_EQ(sent(0.0), "203#0F0000000A");
  EXPECT_EQ(sent(-50.0), "203#0F00F4010A");
  EXPECT_EQ(sent(50.0), "203#0F000CFE0A");
  EXPECT_EQ(sent(0.199), "203#0F00FFFF0A");
  EXPECT_EQ(sent(0.099), "203#0F0000000A");
  EXPECT_EQ(sent(120.0), "203#0F0050FB0A");
  EXPECT_EQ(sent(1e300), "203#0F0050FB0A");
  EXPECT_EQ(sent(-INFINITY), "203#0F0000000A");
  EXPECT_EQ(sent(NAN), "203#0F0000000A");
}

TEST(Cia402, TheTablesForToolsGiveMotorSideUnits) {
  const auto physical = [](const char* frame_text, const char* name) {
    const CanFrame frame = Frame(frame_text);
    for (const CanMessage& message : MessagesOf(Cia402Joint(kNode))) {
      if (message.id != frame.id) continue;
      EXPECT_EQ(message.length, frame.length) << message.name;
      for (const CanSignal& signal : message.signals) {
        if (signal.name == std::string(name)) return GetPhysical(frame, signal);
      }
    }
    return std::nan("");
  };
  EXPECT_DOUBLE_EQ(physical("203#0F00F4010A", "target_torque"), 5.0);
  EXPECT_DOUBLE_EQ(physical("183#37120CFE0A", "torque"), -5.0);
  EXPECT_DOUBLE_EQ(physical("283#0000FFFF00000100", "position"), -0.5);
  EXPECT_DOUBLE_EQ(physical("283#0000FFFF00000100", "velocity"), 0.5);
  EXPECT_EQ(physical("083#1186200200000000", "error_code"), 0x8611);
}

TEST(Cia402, TheDriveFollowsOneLatencyLaterAndWithinTheWiresResolution) {
  for (const bool of_max : {false, true}) {
    JointDriveConfig joint = Cia402Joint(kNode);
    joint.cia402.torque_of_max = of_max;
    Cia402Bench bench({joint});
    ASSERT_LE(bench.BringUpTicks(kSecond), kSecond);
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> torque(-150.0, 150.0);
    for (int i = 0; i < 200; ++i) {
      const double tau_Nm = torque(random);
      const double wanted_Nm = std::clamp(tau_Nm, -120.0, 120.0);
      bench.Command(tau_Nm);
      const double got_Nm = bench.drives[0]->Torque(bench.t_s);
      EXPECT_NEAR(got_Nm, wanted_Nm, of_max ? 0.12 : 0.1);
      EXPECT_LE(std::abs(got_Nm), std::abs(wanted_Nm) + 1e-9);
    }
  }
}

TEST(Cia402, ASampleIsTheJointAtTheSync) {
  JointDriveConfig joint = Cia402Joint(kNode);
  joint.cia402.velocity_per_turn_s = 60.0;  // rpm
  Cia402Bench bench({joint});
  ASSERT_LE(bench.BringUpTicks(kSecond), kSecond);
  bench.truth[0] = {0.7, -1.5};
  const uint64_t before = bench.masters[0]->sample().sequence;
  bench.Command(0.0);
  const JointSample& sample = bench.masters[0]->sample();
  EXPECT_EQ(sample.sequence, before + 1);
  EXPECT_NEAR(sample.position_rad, 0.7, 2.0 * M_PI / 10.0 / 131072.0);
  EXPECT_NEAR(sample.velocity_rad_s, -1.5, 2.0 * M_PI / 10.0 / 60.0 / 2.0);
  EXPECT_GT(sample.stamp_ns, bench.now_ns() - 10'000'000);
}

TEST(Cia402, ASilentMasterTripsTheDriveWhichBrakesAndStaysInFault) {
  Cia402Bench bench = Ready();
  bench.truth[0].velocity_rad_s = 3.0;
  bench.Command(50.0);
  const double last_command_s = bench.t_s - 0.01;
  EXPECT_NEAR(bench.drives[0]->Torque(bench.t_s), 50.0, 0.1);
  bench.Wait(last_command_s + 0.03 - bench.t_s);
  EXPECT_NEAR(bench.drives[0]->Torque(bench.t_s), 50.0, 0.1);
  bench.Wait(0.003);
  EXPECT_EQ(bench.drives[0]->power_state(), PowerState::kFaultReaction);
  EXPECT_DOUBLE_EQ(bench.drives[0]->Torque(bench.t_s), -120.0) << "against the motion";
  bench.truth[0].velocity_rad_s = 0.0;
  bench.Wait(0.01);
  EXPECT_EQ(bench.drives[0]->power_state(), PowerState::kFault);
  EXPECT_FALSE(bench.drives[0]->ProducesTorque());
  // 8250h is in the emergency that the master has heard.
  EXPECT_EQ(bench.masters[0]->error_code(), 0x8250u);
  EXPECT_EQ(bench.masters[0]->state(), DriveState::kFault);
  EXPECT_THAT(bench.masters[0]->Explain(), HasSubstr("0x8250"));
  for (int i = 0; i < 200; ++i) {
    bench.BringUp();
    bench.Command(50.0);
    ASSERT_EQ(bench.drives[0]->Torque(bench.t_s), 0.0);
  }
  EXPECT_EQ(bench.masters[0]->state(), DriveState::kFault);
}

TEST(Cia402, AfterAPersonsResetAnOldFaultIsResetOnTheWayUp) {
  Cia402Bench bench = Ready();
  bench.Wait(0.5);
  ASSERT_EQ(bench.masters[0]->state(), DriveState::kFault);
  bench.masters[0]->Reset();
  EXPECT_LE(bench.BringUpTicks(kSecond), kSecond);
  EXPECT_EQ(bench.masters[0]->error_code(), 0u);
}

TEST(Cia402, AnErrorOfTheDriveIsAFaultAtOnce) {
  Cia402Bench bench = Ready();
  FrameList out;
  bench.drives[0]->Fail(bench.t_s, 0x2310, &out);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_EQ(Text(out[0]), "083#1023010000000000");
  bench.Deliver(out);
  EXPECT_EQ(bench.masters[0]->state(), DriveState::kFault);
  EXPECT_EQ(bench.masters[0]->error_code(), 0x2310u);
}

TEST(Cia402, AFaultIsSeenInTheStatuswordWhenItsEmergencyIsLost) {
  Cia402Bench bench = Ready();
  FrameList lost;
  bench.drives[0]->Fail(bench.t_s, 0x2310, &lost);
  bench.Command(10.0);
  EXPECT_EQ(bench.masters[0]->state(), DriveState::kFault);
}

TEST(Cia402, ALostHeartbeatOfTheDriveEndsTorqueMode) {
  Cia402Bench bench = Ready();
  bench.lost = [](const CanFrame& frame) { return frame.id == 0x700 + kNode; };
  const double from_s = bench.t_s;
  while (bench.masters[0]->state() == DriveState::kTorque && bench.t_s < from_s + 1.0) bench.Command(1.0);
  EXPECT_EQ(bench.masters[0]->state(), DriveState::kFault);
  EXPECT_LE(bench.t_s - from_s, 0.3 + 0.02);
  EXPECT_THAT(bench.masters[0]->Explain(), HasSubstr("heartbeat"));
}

TEST(Cia402, ALostHeartbeatOfTheMasterTripsTheDrive) {
  Cia402Bench bench = Ready();
  bench.lost = [](const CanFrame& frame) { return frame.id == 0x700 + 127; };
  for (int i = 0; i < 45; ++i) bench.Command(1.0);
  EXPECT_FALSE(bench.drives[0]->ProducesTorque());
  EXPECT_EQ(bench.masters[0]->state(), DriveState::kFault);
  EXPECT_EQ(bench.masters[0]->error_code(), 0x8130u);
}

TEST(Cia402, AQuickStopBrakesToRestThenReleases) {
  Cia402Bench bench = Ready();
  bench.truth[0].velocity_rad_s = -1.0;
  FrameList out;
  bench.masters[0]->QuickStop(&out);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_EQ(Text(out[0]), "203#020000000A");
  bench.Exchange(out);
  EXPECT_EQ(bench.drives[0]->power_state(), PowerState::kQuickStop);
  EXPECT_DOUBLE_EQ(bench.drives[0]->Torque(bench.t_s), 60.0);
  EXPECT_EQ(bench.masters[0]->state(), DriveState::kIdle);
  for (int i = 0; i < 10; ++i) bench.Command(50.0);  // the stop stands, and feeds the watchdog
  EXPECT_EQ(bench.drives[0]->power_state(), PowerState::kQuickStop);
  bench.truth[0].velocity_rad_s = 0.0;
  for (int i = 0; i < 10; ++i) {
    bench.Command(50.0);
    bench.BringUp();
  }
  EXPECT_EQ(bench.drives[0]->power_state(), PowerState::kSwitchOnDisabled);
  EXPECT_EQ(bench.masters[0]->state(), DriveState::kIdle);
}

TEST(Cia402, DisableTakesTheTorqueAwayAtOnceForGood) {
  Cia402Bench bench = Ready();
  bench.Command(50.0);
  FrameList out;
  bench.masters[0]->Disable(&out);
  EXPECT_EQ(Text(out[0]), "203#000000000A");
  bench.Exchange(out);
  for (int i = 0; i < 100; ++i) {
    bench.Command(50.0);
    bench.BringUp();
    ASSERT_FALSE(bench.drives[0]->ProducesTorque());
  }
}

TEST(Cia402, ADriveThatRestartsIsNotArmedAgain) {
  Cia402Bench bench = Ready();
  bench.Send(canopen::EncodeNmt(canopen::NmtCommand::kResetNode, kNode));
  for (int i = 0; i < 200; ++i) {
    bench.BringUp();
    bench.Command(50.0);
    ASSERT_FALSE(bench.drives[0]->ProducesTorque());
  }
  EXPECT_EQ(bench.masters[0]->state(), DriveState::kFault);
}

TEST(Cia402, ARatedTorqueOtherThanConfiguredRefusesTheDrive) {
  JointDriveConfig wired = Cia402Joint(kNode);
  wired.cia402.rated_torque_Nm = 9.8;
  Cia402Bench bench({wired});
  bench.masters = MakeDrives(std::vector{Cia402Joint(kNode)});
  bench.BringUpTicks(kSecond);
  EXPECT_EQ(bench.masters[0]->state(), DriveState::kFault);
  EXPECT_EQ(bench.masters[0]->Explain(),
            "6076:00 reads 9800, expected is 10000 (cia402.rated_torque_Nm in mN m)");
}

/// A master whose drive answers every SDO but one as it should.
std::string ExplainWith(canopen::Entry entry, const std::string& answer, DriveWatchdog* watchdog) {
  Cia402Bench bench({Cia402Joint(kNode)});
  bench.lost = [&](const CanFrame& frame) {
    canopen::Sdo reply;
    if (!canopen::DecodeSdoReply(frame, kNode, &reply) || reply.entry != entry) return false;
    bench.masters[0]->OnFrame(Frame(answer));
    return true;
  };
  bench.BringUpTicks(kSecond);
  EXPECT_FALSE(bench.drives[0]->ProducesTorque());
  *watchdog = bench.masters[0]->watchdog();
  return bench.masters[0]->Explain();
}

TEST(Cia402, AnAbortedRequestIsNamed) {
  DriveWatchdog watchdog{};
  EXPECT_EQ(ExplainWith({0x6060, 0}, "583#8060600000000206", &watchdog),
            "SDO abort 0x06020000 (object does not exist) writing 6060:00");
  EXPECT_EQ(watchdog, DriveWatchdog::kUnproved);
}

TEST(Cia402, ADriveWithoutATimeoutOfItsRpdoHasNoWatchdog) {
  DriveWatchdog watchdog{};
  EXPECT_EQ(ExplainWith({0x1400, 5}, "583#8000140511000906", &watchdog),
            "SDO abort 0x06090011 (sub-index does not exist) writing 1400:05");
  EXPECT_EQ(watchdog, DriveWatchdog::kOff);
}

TEST(Cia402, LostFramesDelayTheBringUpButDoNotStopIt) {
  Cia402Bench bench({Cia402Joint(kNode)});
  std::mt19937_64 random(3);
  bench.lost = [&](const CanFrame&) { return random() % 10 == 0; };
  EXPECT_LE(bench.BringUpTicks(10 * kSecond), 10 * kSecond) << bench.masters[0]->Explain();
}

TEST(Cia402, NonsenseOfTheDrivesIdentifiersIsMalformedAndChangesNothing) {
  Cia402Bench bench = Ready();
  JointDrive& master = *bench.masters[0];
  const JointSample before = master.sample();
  for (const char* text :
       {"703#", "703#06", "083#1023", "583#60", "183#2702", "183#050000000A", "283#00000000"}) {
    EXPECT_EQ(master.OnFrame(Frame(text)), Reception::kMalformed) << text;
  }
  for (const char* text : {"00000703#05", "704#05", "203#0F0000000A", "383#00", "703#R"}) {
    EXPECT_EQ(master.OnFrame(Frame(text)), Reception::kNotMine) << text;
  }
  EXPECT_EQ(master.state(), DriveState::kTorque);
  EXPECT_EQ(master.sample().sequence, before.sequence);
}

TEST(Cia402, RandomFramesNeverArmADriveNorItsMaster) {
  Cia402Bench bench({Cia402Joint(kNode)});
  std::mt19937_64 random(11);
  constexpr uint32_t kIds[] = {0x083, 0x183, 0x283, 0x583, 0x703};
  for (int64_t i = 0; i < 200'000; ++i) {
    CanFrame frame;
    frame.id = kIds[random() % std::size(kIds)];
    frame.length = static_cast<uint8_t>(random() % 9);
    for (size_t k = 0; k < 8; ++k) frame.data[k] = static_cast<uint8_t>(random() >> 8 * k);
    frame.stamp_ns = i * 1000;
    bench.masters[0]->OnFrame(frame);
    if (i % 100 == 0) {
      FrameList out;
      bench.masters[0]->BringUp(i * 1000, &out);
      for (const CanFrame& sent : out) {
        ASSERT_TRUE(!IsCommand(sent) || TorqueOf(sent) == 0);
      }
    }
    ASSERT_NE(bench.masters[0]->state(), DriveState::kTorque);
  }
}

TEST(Cia402, NothingIsAllocatedAfterConstruction) {
  Cia402Bench bench({Cia402Joint(1), Cia402Joint(2)});
  LimitMalloc guard;
  bench.BringUpTicks(kSecond);
  for (int i = 0; i < 50; ++i) bench.Command(i);
  bench.Wait(0.5);
}

TEST(Cia402, FiltersPassTheNodesFramesAndTheBussesOwn) {
  const auto passes = [](const JointDrive& drive, const CanFrame& frame) {
    const auto filters = drive.Filters();
    return std::any_of(filters.begin(), filters.end(), [&](const auto& f) { return Passes(f, frame); });
  };
  const auto drives = MakeDrives(std::vector{Cia402Joint(1), Cia402Joint(2)});
  for (const char* text :
       {"081#", "181#", "201#", "281#", "581#", "601#", "701#00", "000#", "080#", "77F#05"}) {
    EXPECT_TRUE(passes(*drives[0], Frame(text))) << text;
  }
  for (const char* text : {"182#", "00000181#", "702#00"})
    EXPECT_FALSE(passes(*drives[0], Frame(text))) << text;
  EXPECT_FALSE(passes(*drives[1], Frame("080#"))) << "the first drive's";
}

}  // namespace
}  // namespace armada
