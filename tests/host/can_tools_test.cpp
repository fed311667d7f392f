// armada can: decoding, finding drives, judging buses.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <sstream>

#include "firmware/can/odrive_messages.h"
#include "hil/can_log.h"
#include "host/can/can_check.h"
#include "host/can/candump_reader.h"
#include "host/can/decode.h"
#include "host/can/scan_output.h"
#include "tests/host/can_bench.h"

namespace armada {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

CandumpLine ReadLine(const std::string& text) {
  CandumpLine line;
  EXPECT_TRUE(ParseCandumpLine(text, &line)) << text;
  return line;
}

std::string DecodeLine(DriveProfile profile, const std::string& text) {
  return Decode(MessagesOfProfile(profile), ReadLine(text).frame);
}

// Lines as can-utils' candump(1) and log2asc take them.
TEST(CandumpReader, ReadsWhatCandumpWrites) {
  const CandumpLine line = ReadLine("(1436509052.249713) vcan0 044#2A366C2BBA");
  EXPECT_EQ(line.time_ns, 1'436'509'052'249'713'000);
  EXPECT_EQ(line.channel, "vcan0");
  EXPECT_EQ(line.frame.id, 0x44u);
  EXPECT_FALSE(line.frame.extended);
  EXPECT_EQ(line.frame.length, 5);
  EXPECT_EQ(line.frame.data[4], 0xBA);
  EXPECT_TRUE(ReadLine("(1.0) can0 00000044#").frame.extended);
  EXPECT_TRUE(ReadLine("(1.0) can0 20000040#0000000000000000").frame.error);
  EXPECT_TRUE(ReadLine("(1.0) can0 123##31122").frame.error_state_indicator);
  EXPECT_EQ(ReadLine("(1.0) can0 029#R8").frame.length, 8);
  EXPECT_EQ(ReadLine("(1.0) can0 029#00 R").frame.length, 1);
}

TEST(CandumpReader, GivesBackWhatOurLogWrote) {
  for (const CanFrame& frame :
       Conversation(std::array{JointDriveConfig{.profile = DriveProfile::kMoteus, .node_id = 1}})) {
    std::array<char, kMaxCanLogLine> text{};
    const size_t size = FormatCanLogLine(5'000'007'000, "can3", frame, text);
    const CandumpLine line = ReadLine(std::string(text.data(), size - 1));
    ASSERT_EQ(RawText(line.frame), RawText(frame));
    ASSERT_EQ(line.time_ns, 5'000'007'000);
  }
}

TEST(CandumpReader, RefusesWhatIsNoLine) {
  CandumpLine line;
  for (const char* text : {"", "x", "(1.0) can0", "(1.0) can0 12#00", "1.0 can0 123#00", "(1.0) can0 123#0",
                           "(1.0) can0 123#000000000000000000", "(1.0) can0 123#R9", "(1.0) can0 FFF#00",
                           "(1.0) can0 123##", "(99999999999999999999.0) can0 123#00", "(1.x) can0 123#00"}) {
    EXPECT_FALSE(ParseCandumpLine(text, &line)) << text;
  }
}

TEST(Decode, NamesWhoseMessageItIsAndGivesPhysicalUnits) {
  // position 1.0 rev and velocity -2.0 rev/s as IEEE 754 floats, little-endian
  EXPECT_EQ(DecodeLine(DriveProfile::kODriveCanSimple, "(1.0) can0 029#0000803F000000C0"),
            "N1 EncoderEstimates position=1 rev velocity=-2 rev/s");
  EXPECT_EQ(DecodeLine(DriveProfile::kODriveCanSimple, "(1.0) can0 029#R8"), "N1 EncoderEstimates asked for");
}

TEST(Decode, ShowsEveryBitOfAnInteger) {
  // error 0x1000000: 0.6's watchdog
  EXPECT_EQ(DecodeLine(DriveProfile::kODriveCanSimple, "(1.0) can0 021#0000000101030000"),
            "N1 Heartbeat axis_error=16777216 axis_state=1 procedure_result=3");
}

TEST(Decode, TakesSpecialFramesForWhatTheyAre) {
  EXPECT_THAT(DecodeLine(DriveProfile::kMiniCheetah, "(1.0) can0 003#FFFFFFFFFFFFFFFC"),
              HasSubstr("N3 Enable"));
  EXPECT_THAT(DecodeLine(DriveProfile::kMiniCheetah, "(1.0) can0 003#7FFF7FF0000007FF"),
              HasSubstr("N3 Command"));
}

TEST(Decode, ShowsWhatItDoesNotKnowAsItIs) {
  EXPECT_EQ(DecodeLine(DriveProfile::kODriveCanSimple, "(1.0) can0 12345678#01"), "unknown  12345678#01");
  EXPECT_EQ(DecodeLine(DriveProfile::kODriveCanSimple, "(1.0) can0 029#00"),
            "N1 EncoderEstimates too short: 1 of 8 bytes  029#00");
}

TEST(Decode, NamesErrorFrames) {
  EXPECT_THAT(DecodeLine(DriveProfile::kODriveCanSimple, "(1.0) can0 20000040#0000000000000000"),
              HasSubstr("error frame: bus off"));
  EXPECT_EQ(ErrorClassName(0x84), "controller problem, bus error");
}

TEST(Decode, SharedMessagesHaveNoOwner) {
  EXPECT_THAT(DecodeLine(DriveProfile::kCia402, "(1.0) can0 080#"), testing::StartsWith("Sync"));
}

std::vector<JointDriveConfig> OneOfEach() {
  std::vector<JointDriveConfig> joints = {{.profile = DriveProfile::kODriveCanSimple, .node_id = 17},
                                          {.profile = DriveProfile::kODriveCanSimpleV05, .node_id = 18},
                                          {.profile = DriveProfile::kDamiao, .node_id = 4},
                                          {.profile = DriveProfile::kCia402, .node_id = 5},
                                          {.profile = DriveProfile::kMoteus, .node_id = 6},
                                          {.profile = DriveProfile::kMiniCheetah, .node_id = 7}};
  joints[2].mit.master_id = 0x14;
  return joints;
}

ScanResult ScanOf(EmulatedBus* bus, bool fd = true) {
  ScanOptions options;
  options.fd = fd;
  return Scan(bus, options, 0);
}

TEST(Scan, FindsEveryDriveThatCanBeAsked) {
  EmulatedBus bus(OneOfEach());
  const ScanResult result = ScanOf(&bus);
  std::vector<std::string> found;
  for (const FoundDrive& drive : result.drives) {
    found.push_back(drive.profile + " " + std::to_string(drive.node_id));
  }
  EXPECT_THAT(found, testing::ElementsAre("cia402 5", "damiao 4", "moteus 6", "odrive_cansimple 17",
                                          "odrive_cansimple_v05 18"));
  EXPECT_EQ(result.drives[1].state, "answers on 14h");
  EXPECT_EQ(result.drives[2].firmware, "register map 5");
  EXPECT_EQ(result.drives[3].firmware, "0.6.10");
  EXPECT_EQ(result.drives[4].firmware, "0.5 (does not tell)");
}

// A heartbeat of firmware 0.5 has the flag "trajectory done" in the highest bit, one of 0.6 in bit 48.
TEST(Scan, TellsFirmware05ByItsHeartbeatWhereItCan) {
  EmulatedBus bus({});
  CanFrame heartbeat = odrive::EncodeHeartbeat(3, odrive::Firmware::kV05, {0, odrive::AxisState::kIdle, 0});
  heartbeat.data[7] = 0x80;
  bus.Inject(heartbeat);
  const ScanResult result = ScanOf(&bus);
  ASSERT_THAT(result.drives, SizeIs(1));
  EXPECT_EQ(result.drives[0].profile, "odrive_cansimple_v05");
  for (const CanFrame& frame : bus.sent) EXPECT_FALSE(frame.remote) << RawText(frame);
}

// What the scan may say: remote frames, SDO uploads, reads of registers.
TEST(Scan, SendsNothingButQuestions) {
  EmulatedBus bus(OneOfEach());
  (void)ScanOf(&bus);
  ASSERT_THAT(bus.sent, testing::Not(IsEmpty()));
  for (const CanFrame& frame : bus.sent) {
    const bool version = frame.remote && (frame.id & 0x1F) == 0;
    const bool upload = frame.id > 0x600 && frame.id < 0x680 && frame.data[0] == 0x40;
    const bool damiao_read = frame.id == 0x7FF && frame.data[2] == 0x33;
    const bool moteus_read = frame.fd && frame.extended && frame.data[0] == 0x11 && frame.data[2] == 0x1F;
    EXPECT_TRUE(version || upload || damiao_read || moteus_read) << RawText(frame);
  }
  for (const auto& drive : bus.drives) EXPECT_FALSE(drive->ProducesTorque());
}

TEST(Scan, SendsNoCanFdToAClassicBus) {
  EmulatedBus bus(OneOfEach());
  const ScanResult result = ScanOf(&bus, false);
  for (const CanFrame& frame : bus.sent) EXPECT_FALSE(frame.fd);
  EXPECT_THAT(result.notes, testing::Contains(HasSubstr("moteus was not asked")));
}

TEST(Scan, OnlyListensWhereSomebodyCommands) {
  EmulatedBus bus(OneOfEach());
  CanFrame torque;
  torque.id = 17u << 5 | 0x0E;
  torque.length = 4;
  bus.Inject(torque);
  const ScanResult result = ScanOf(&bus);
  EXPECT_THAT(bus.sent, IsEmpty());
  EXPECT_THAT(result.drives, SizeIs(testing::Ge(2u)));
  EXPECT_THAT(result.notes, testing::ElementsAre(HasSubstr("in use (frame 22Eh)")));
}

TEST(Scan, OnlyListensWhereAnODriveIsArmed) {
  EmulatedBus bus({});
  bus.Inject(odrive::EncodeHeartbeat(3, odrive::Firmware::kV06, {0, odrive::AxisState::kClosedLoop, 1}));
  const ScanResult result = ScanOf(&bus);
  EXPECT_THAT(bus.sent, IsEmpty());
  EXPECT_THAT(result.notes, testing::ElementsAre(HasSubstr("ODrive 3 is armed")));
}

TEST(Scan, AsksNoCanopenWhereItsIdentifiersAreAnODrives) {
  EmulatedBus bus(std::array{JointDriveConfig{.profile = DriveProfile::kODriveCanSimple, .node_id = 49}});
  (void)ScanOf(&bus);
  for (const CanFrame& frame : bus.sent) {
    EXPECT_TRUE(frame.remote || frame.id <= 0x600 || frame.id >= 0x680) << RawText(frame);
  }
}

ArmEntry Arm(DriveProfile profile) {
  ArmEntry entry;
  entry.id = 1;
  entry.bus = "udp:239.74.163.7:43107";
  for (const int node : {1, 2}) {
    entry.joints.push_back(
        {.profile = profile, .node_id = node, .gear_ratio = 10.0, .torque_limit_Nm = 50.0});
  }
  return entry;
}

TEST(CanCheck, TellsWhichWatchdogsNothingProves) {
  FleetConfig fleet;
  fleet.arms = {Arm(DriveProfile::kCubeMars)};
  const CanCheckResult result = CheckCan(fleet);
  EXPECT_TRUE(result.ok());
  ASSERT_THAT(result.findings, SizeIs(1));
  EXPECT_THAT(result.findings[0].text, HasSubstr("arm 1: nothing proves the watchdogs of joints 1, 2"));
}

TEST(CanCheck, FailsABusThatCannotCarryItsTraffic) {
  FleetConfig fleet;
  fleet.arms = {Arm(DriveProfile::kODriveCanSimple)};
  EXPECT_THAT(CheckCan(fleet).findings, IsEmpty());
  fleet.arms[0].can.bitrate_bit_s = 2e4;
  const CanCheckResult result = CheckCan(fleet);
  EXPECT_FALSE(result.ok());
  EXPECT_THAT(result.findings.at(0).text, HasSubstr("its bus would have to carry"));
}

}  // namespace
}  // namespace armada
