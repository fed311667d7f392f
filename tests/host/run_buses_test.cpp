#include "host/run/run_buses.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace armada {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

FleetConfig Fleet() {
  FleetConfig fleet;
  fleet.arms.resize(2);
  fleet.arms[0].id = 1;
  fleet.arms[0].bus = "udp:239.74.163.11:43113";
  fleet.arms[1].id = 5;
  fleet.arms[1].bus = "socketcan:can0";
  return fleet;
}

RunOptions Options(const std::string& bus, const std::vector<std::string>& hil_buses = {}) {
  RunOptions options;
  options.bus = bus;
  options.hil_buses = hil_buses;
  return options;
}

TEST(ChooseBuses, SocketCanGivesAnInterfaceToArmsThatNameNone) {
  for (const char* bus : {"socketcan", "vm"}) {
    FleetConfig fleet = Fleet();
    EXPECT_EQ(ChooseBuses(Options(bus), &fleet), "");
    EXPECT_EQ(fleet.arms[0].bus, "socketcan:vcan1");
    EXPECT_EQ(fleet.arms[1].bus, "socketcan:can0");
  }
}

TEST(ChooseBuses, UdpLeavesTheFleetAndRefusesInterfaces) {
  FleetConfig fleet = Fleet();
  EXPECT_THAT(ChooseBuses(Options("udp"), &fleet), HasSubstr("arm 5 has bus socketcan:can0"));
  fleet.arms[1].bus = "udp:239.74.163.12:43113";
  EXPECT_EQ(ChooseBuses(Options("udp"), &fleet), "");
  EXPECT_EQ(fleet.arms[0].bus, "udp:239.74.163.11:43113");
}

TEST(ChooseBuses, OptionsThatDoNotFitAreNamed) {
  FleetConfig fleet = Fleet();
  EXPECT_THAT(ChooseBuses(Options("flexray"), &fleet), HasSubstr("--bus flexray"));
  EXPECT_THAT(ChooseBuses(Options("socketcan", {"1=can1"}), &fleet), HasSubstr("--hil-bus 1=can1"));
  RunOptions two_ends = Options("socketcan", {"1=socketcan:can1"});
  two_ends.namespaces = true;
  EXPECT_THAT(ChooseBuses(two_ends, &fleet), HasSubstr("without --namespaces"));
}

TEST(SocketCanInterfaces, AreTheBoardsThenTheEmulations) {
  FleetConfig fleet = Fleet();
  EXPECT_THAT(SocketCanInterfaces(fleet, {}), ElementsAre("can0"));
  EXPECT_THAT(SocketCanInterfaces(fleet, {"5=socketcan:can1"}), ElementsAre("can0", "can1"));
  fleet.arms.pop_back();
  EXPECT_THAT(SocketCanInterfaces(fleet, {}), IsEmpty());
}

TEST(PrintCanInterfaces, TellsWhatWasMadeFromWhatWasThere) {
  std::ostringstream out;
  PrintCanInterfaces({"can0", "vcan1", "vcan2"}, {"vcan1", "vcan2"}, out);
  EXPECT_EQ(out.str(),
            "CAN interfaces made for this run: vcan1 vcan2\n"
            "CAN interfaces used as they are: can0\n");
}

}  // namespace
}  // namespace armada
