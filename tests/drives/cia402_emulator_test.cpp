#include "hil/cia402_emulator.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/drives/cia402_bench.h"
#include "tests/drives/cia402_bytes.h"

namespace armada {
namespace {

/// The emulated drive alone, node 3, spoken to in bytes; what it says as text.
class Drive {
 public:
  explicit Drive(double boot_s = 0.03) { Wait(boot_s); }

  std::vector<std::string> Send(const std::string& frame) {
    FrameList out;
    t_s += 0.0005;
    drive.OnFrame(t_s, Frame(frame), truth, &out);
    return Texts(out);
  }
  std::vector<std::string> Wait(double dt_s) {
    const double end_s = t_s + dt_s;
    std::vector<std::string> texts;
    for (double next_s = drive.NextEvent(t_s); next_s <= end_s; next_s = drive.NextEvent(t_s)) {
      t_s = next_s;
      FrameList out;
      drive.OnTime(t_s, truth, &out);
      for (const std::string& text : Texts(out)) texts.push_back(text);
    }
    t_s = end_s;
    return texts;
  }
  std::string Sdo(const std::string& payload) {
    const auto answers = Send("603#" + payload);
    return answers.size() == 1 ? answers[0] : std::to_string(answers.size()) + " answers";
  }
  /// State bits of the statusword, read by SDO.
  unsigned State() {
    const CanFrame reply = Frame(Sdo("4041600000000000"));
    return reply.data[4] & 0x6Fu;
  }
  void Control(unsigned word) {
    char text[24];
    std::snprintf(text, sizeof text, "2B406000%02X%02X0000", word & 0xFF, word >> 8);
    EXPECT_EQ(Sdo(text), "583#6040600000000000");
  }

  static std::vector<std::string> Texts(const FrameList& frames) {
    std::vector<std::string> texts;
    for (const CanFrame& frame : frames) texts.push_back(Text(frame));
    return texts;
  }

  Cia402Emulator drive{Cia402Joint(3), {}, 1};
  JointTruth truth;
  double t_s = 0.0;
};

using Texts = std::vector<std::string>;

TEST(Cia402Emulator, BootsIntoPreOperationalAndSaysNothingElse) {
  Drive drive(0.0);
  EXPECT_EQ(drive.Send("603#4000100000000000"), Texts{}) << "still booting";
  EXPECT_EQ(drive.Wait(0.03), Texts{"703#00"});
  EXPECT_EQ(drive.Wait(1.0), Texts{});
  EXPECT_EQ(drive.Send("080#"), Texts{}) << "no process data before operational";
  EXPECT_EQ(drive.State(), 0x40u);
}

TEST(Cia402Emulator, TheSdoServerAnswersAsCia301HasIt) {
  Drive drive;
  EXPECT_EQ(drive.Sdo("4000100000000000"), "583#4300100092010200") << "device type 402, servo";
  EXPECT_EQ(drive.Sdo("4076600000000000"), "583#4376600010270000") << "10 000 mN m";
  EXPECT_EQ(drive.Sdo("40FFFF0000000000"), "583#80FFFF0000000206") << "no such object";
  EXPECT_EQ(drive.Sdo("4000140700000000"), "583#8000140711000906") << "no such sub-index";
  EXPECT_EQ(drive.Sdo("2B41600000000000"), "583#8041600002000106") << "read only";
  EXPECT_EQ(drive.Sdo("2B6060000A000000"), "583#8060600012000706") << "too long";
  EXPECT_EQ(drive.Sdo("2F7260000A000000"), "583#8072600013000706") << "too short";
  EXPECT_EQ(drive.Sdo("2B5A600009000000"), "583#805A600031000906") << "too high";
  EXPECT_EQ(drive.Sdo("2B5A6000FFFF0000"), "583#805A600032000906") << "too low";
  EXPECT_EQ(drive.Sdo("2F60600008000000"), "583#8060600030000906") << "position mode, not supported";
  EXPECT_EQ(drive.Sdo("2108100005000000"), "583#8008100001000405") << "segmented";
  EXPECT_EQ(drive.Sdo("2F6060000A000000"), "583#6060600000000000");
  EXPECT_EQ(drive.Sdo("4061600000000000"), "583#4F6160000A000000") << "in force";
  EXPECT_EQ(drive.Sdo("2260600000000000"), "583#6060600000000000") << "length left open";
}

TEST(Cia402Emulator, AMappingChangesOnlyWhileThePdoDoesNotExist) {
  Drive drive;
  EXPECT_EQ(drive.Sdo("2F00160000000000"), "583#8000160000000106") << "the PDO exists";
  EXPECT_EQ(drive.Sdo("2300140104020000"), "583#8000140130000906") << "another id while it exists";
  EXPECT_EQ(drive.Sdo("2300140103020080"), "583#6000140100000000");
  EXPECT_EQ(drive.Sdo("2300160110004060"), "583#8000160100000106") << "not emptied";
  EXPECT_EQ(drive.Sdo("2F00160000000000"), "583#6000160000000000");
  EXPECT_EQ(drive.Sdo("2300160110004160"), "583#8000160141000406") << "received, but read only";
  EXPECT_EQ(drive.Sdo("2300160110007260"), "583#8000160141000406") << "not mappable";
  EXPECT_EQ(drive.Sdo("2300160108004060"), "583#8000160141000406") << "half of an object";
  EXPECT_EQ(drive.Sdo("2300160110001234"), "583#8000160100000206") << "no such object";
  EXPECT_EQ(drive.Sdo("2300160110004060"), "583#6000160100000000");
  EXPECT_EQ(drive.Sdo("2F00160003000000"), "583#8000160041000406") << "nothing at the second";
  EXPECT_EQ(drive.Sdo("2F00160009000000"), "583#8000160031000906");
  EXPECT_EQ(drive.Sdo("2F00160001000000"), "583#6000160000000000");
  EXPECT_EQ(drive.Sdo("2F0014024B000000"), "583#6000140200000000");
  EXPECT_EQ(drive.Sdo("2F001402F5000000"), "583#8000140230000906") << "reserved type";
  EXPECT_EQ(drive.Sdo("2300140103020000"), "583#6000140100000000");
  // 12 bytes do not fit into a frame.
  EXPECT_EQ(drive.Sdo("23011801830200C0"), "583#6001180100000000");
  EXPECT_EQ(drive.Sdo("2F011A0000000000"), "583#60011A0000000000");
  for (const char* sub : {"01", "02", "03"}) {
    EXPECT_EQ(drive.Sdo(std::string("23011A") + sub + "20006460"),
              std::string("583#60011A") + sub + "00000000");
  }
  EXPECT_EQ(drive.Sdo("2F011A0003000000"), "583#80011A0042000406");
}

// Edges of the state machine, CiA 402-2 figure "power drive system": from, controlword, to.
TEST(Cia402Emulator, TheStateMachineIsThatOfCia402) {
  struct Edge {
    std::vector<unsigned> path;
    unsigned word;
    unsigned state;
  };
  const std::vector<unsigned> disabled = {};
  const std::vector<unsigned> ready = {0x06};
  const std::vector<unsigned> on = {0x06, 0x07};
  const std::vector<unsigned> enabled = {0x06, 0x07, 0x0F};
  const Edge kEdges[] = {
      {disabled, 0x06, 0x21}, {disabled, 0x07, 0x40}, {disabled, 0x0F, 0x40}, {disabled, 0x02, 0x40},
      {disabled, 0x80, 0x40}, {ready, 0x07, 0x23},    {ready, 0x0F, 0x27},    {ready, 0x00, 0x40},
      {ready, 0x02, 0x40},    {on, 0x06, 0x21},       {on, 0x0F, 0x27},       {on, 0x00, 0x40},
      {on, 0x02, 0x40},       {enabled, 0x07, 0x23},  {enabled, 0x06, 0x21},  {enabled, 0x00, 0x40},
      {enabled, 0x02, 0x07},  {enabled, 0x8F, 0x27},
  };
  for (const Edge& edge : kEdges) {
    Drive drive;
    drive.truth.velocity_rad_s = 1.0;  // a quick stop takes its time
    for (const unsigned word : edge.path) drive.Control(word);
    drive.Control(edge.word);
    EXPECT_EQ(drive.State(), edge.state) << edge.path.size() << " words, then " << edge.word;
  }
}

TEST(Cia402Emulator, AFaultIsResetByARisingEdgeOnly) {
  Drive drive;
  drive.Control(0x80);
  FrameList out;
  drive.drive.Fail(drive.t_s, 0x3210, &out);
  EXPECT_EQ(Drive::Texts(out), Texts{"083#1032010000000000"});
  EXPECT_EQ(drive.State(), 0x08u);
  drive.Control(0x80);
  EXPECT_EQ(drive.State(), 0x08u) << "the bit was set before";
  drive.Control(0x0F);
  EXPECT_EQ(drive.State(), 0x08u);
  EXPECT_EQ(drive.Send("603#2B40600080000000"), (Texts{"583#6040600000000000", "083#0000000000000000"}));
  EXPECT_EQ(drive.State(), 0x40u);
}

TEST(Cia402Emulator, AQuickStopEndsAsItsOptionCodeSays) {
  struct Case {
    int option;
    unsigned moving;
    unsigned at_rest;
  };
  for (const Case& c : {Case{0, 0x40, 0x40}, Case{2, 0x07, 0x40}, Case{6, 0x07, 0x07}}) {
    Drive drive;
    EXPECT_EQ(drive.Sdo("2B5A60000" + std::to_string(c.option) + "000000"), "583#605A600000000000");
    for (const unsigned word : {0x06u, 0x07u, 0x0Fu}) drive.Control(word);
    drive.truth.velocity_rad_s = 0.5;
    drive.Control(0x02);
    drive.Wait(0.01);
    EXPECT_EQ(drive.State(), c.moving) << c.option;
    EXPECT_EQ(drive.drive.Torque(drive.t_s), c.option == 0 ? 0.0 : -25.0);
    drive.truth.velocity_rad_s = 0.0;
    drive.Wait(0.01);
    EXPECT_EQ(drive.State(), c.at_rest) << c.option;
    EXPECT_EQ(drive.drive.Torque(drive.t_s), 0.0);
  }
}

TEST(Cia402Emulator, ProcessDataAreAsTheMasterMapsThem) {
  Drive drive;
  drive.Sdo("23001801830100C0");
  drive.Sdo("2F001A0000000000");
  drive.Sdo("23001A0108006160");
  drive.Sdo("23001A0220006460");
  drive.Sdo("2F001A0002000000");
  drive.Sdo("2F00180202000000");  // every other SYNC
  drive.Sdo("2300180183010040");
  drive.Sdo("2301180183020080");
  drive.Sdo("2F6060000A000000");
  EXPECT_EQ(drive.Send("000#0103"), Texts{});
  drive.truth.position_rad = 0.5 - 2.0 * M_PI / 10.0;  // one motor turn the other way: direction is -1
  EXPECT_EQ(drive.Send("080#"), Texts{});
  EXPECT_EQ(drive.Send("080#"), Texts{"183#0A00000200"});
  EXPECT_EQ(drive.Send("000#0203"), Texts{});
  EXPECT_EQ(drive.Send("080#"), Texts{}) << "stopped";
  EXPECT_EQ(drive.Send("603#4061600000000000"), Texts{}) << "stopped: no SDO either";
  drive.Send("000#8003");
  EXPECT_EQ(drive.Sdo("4061600000000000"), "583#4F6160000A000000");
}

TEST(Cia402Emulator, AnRpdoThatIsTooShortIsReportedAndNotTaken) {
  Drive drive;
  drive.Send("000#0103");
  EXPECT_EQ(drive.Send("203#06"), Texts{"083#1082110000000000"});
  EXPECT_EQ(drive.State(), 0x40u);
  EXPECT_EQ(drive.Send("203#0600FFFF"), Texts{}) << "longer than mapped: the rest is ignored";
  EXPECT_EQ(drive.State(), 0x21u);
}

TEST(Cia402Emulator, ASynchronousRpdoActsAtTheNextSync) {
  Drive drive;
  drive.Sdo("2F00140201000000");
  drive.Send("000#0103");
  drive.Send("203#0600");
  EXPECT_EQ(drive.State(), 0x40u);
  drive.Send("080#");
  EXPECT_EQ(drive.State(), 0x21u);
}

TEST(Cia402Emulator, TheHeartbeatIsSentAtItsPeriodWithTheState) {
  Drive drive;
  drive.Sdo("2B17100064000000");  // 100 ms
  EXPECT_EQ(drive.Wait(0.25), (Texts{"703#7F", "703#7F"}));
  drive.Send("000#0103");
  EXPECT_EQ(drive.Wait(0.1), Texts{"703#05"});
  drive.Sdo("2B17100000000000");
  EXPECT_EQ(drive.Wait(1.0), Texts{});
}

TEST(Cia402Emulator, ALostMasterActsAsItsOptionCodeSays) {
  struct Case {
    int option;
    unsigned state;
  };
  for (const Case& c : {Case{0, 0x27}, Case{1, 0x0F}, Case{2, 0x40}, Case{3, 0x07}}) {
    Drive drive;
    drive.Sdo("2B0760000" + std::to_string(c.option) + "000000");
    drive.Sdo("231610011E007F00");  // node 127, 30 ms
    EXPECT_EQ(drive.Wait(0.1), Texts{}) << "not watched before its first heartbeat";
    drive.truth.velocity_rad_s = 1.0;
    for (const unsigned word : {0x06u, 0x07u, 0x0Fu}) drive.Control(word);
    drive.Send("77F#05");
    EXPECT_EQ(drive.Wait(0.029), Texts{});
    EXPECT_EQ(drive.Wait(0.002), Texts{"083#3081110000000000"});
    EXPECT_EQ(drive.State(), c.state) << c.option;
  }
}

TEST(Cia402Emulator, TheTimeoutOfTheRpdoRunsFromTheFirstOfThem) {
  Drive drive;
  drive.Sdo("2B0014051E000000");  // 30 ms
  drive.Send("000#0103");
  EXPECT_EQ(drive.Wait(0.1), Texts{});
  drive.Send("203#0600");
  EXPECT_EQ(drive.Wait(0.0299), Texts{});
  EXPECT_EQ(drive.Wait(0.0002), Texts{"083#5082110000000000"});
  EXPECT_EQ(drive.State(), 0x21u) << "without power there is nothing to react with";
}

TEST(Cia402Emulator, TorqueIsWithinMaxTorqueAndTheStatuswordTells) {
  Drive drive;
  drive.Sdo("2F6060000A000000");
  drive.Sdo("2B726000F4010000");  // 50 %
  for (const unsigned word : {0x06u, 0x07u, 0x0Fu}) drive.Control(word);
  drive.Sdo("2B716000E8030000");  // 100 %
  drive.Wait(0.01);
  EXPECT_DOUBLE_EQ(drive.drive.Torque(drive.t_s), -50.0) << "5 N m, gear 10, direction -1";
  EXPECT_EQ(drive.Sdo("4041600000000000"), "583#4B41600037180000") << "1837h: follows, limited, not remote";
}

}  // namespace
}  // namespace armada
