#include "firmware/can/bus_name.h"

#include <gtest/gtest.h>

#include "firmware/can/open_bus.h"
#include "firmware/clock/machine_clock.h"

namespace armada {
namespace {

TEST(BusName, AUdpNameIsTakenApart) {
  std::string error;
  const auto name = ParseBusName("udp:239.74.163.11:43113", &error);
  ASSERT_TRUE(name) << error;
  EXPECT_EQ(name->kind, BusKind::kUdp);
  EXPECT_EQ(name->group, "239.74.163.11");
  EXPECT_EQ(name->port, 43113);
  EXPECT_EQ(name->ttl, 0) << "frames stay on this host unless asked";
}

TEST(BusName, AUdpNameMaySetTheTtl) {
  std::string error;
  const auto name = ParseBusName("udp:224.0.0.1:65535?ttl=255", &error);
  ASSERT_TRUE(name) << error;
  EXPECT_EQ(name->port, 65535);
  EXPECT_EQ(name->ttl, 255);
}

TEST(BusName, ASocketCanNameIsTakenApart) {
  std::string error;
  const auto name = ParseBusName("socketcan:can0", &error);
  ASSERT_TRUE(name) << error;
  EXPECT_EQ(name->kind, BusKind::kSocketCan);
  EXPECT_EQ(name->interface_name, "can0");
}

TEST(BusName, ABadNameIsRefusedWithWhatWasGivenAndWhatIsAllowed) {
  struct Bad {
    const char* name;
    const char* problem;
  };
  constexpr Bad kBad[] = {
      {"", "unknown kind of bus"},
      {"can0", "unknown kind of bus"},
      {"UDP:239.1.1.1:1", "unknown kind of bus"},
      {"udp:239.1.1.1", "port is missing"},
      {"udp:10.0.0.1:43113", "\"10.0.0.1\" is not an IPv4 multicast address"},
      {"udp:localhost:43113", "\"localhost\" is not an IPv4 multicast address"},
      {"udp:ff15::1:43113", "is not an IPv4 multicast address"},
      {"udp::43113", "\"\" is not an IPv4 multicast address"},
      {"udp:239.1.1.1:0", "port \"0\""},
      {"udp:239.1.1.1:65536", "port \"65536\""},
      {"udp:239.1.1.1:12x", "port \"12x\""},
      {"udp:239.1.1.1:", "port \"\""},
      {"udp:239.1.1.1:-1", "port \"-1\""},
      {"udp:239.1.1.1:99999999999", "port"},
      {"udp:239.1.1.1:1?ttl=256", "?ttl=256"},
      {"udp:239.1.1.1:1?hops=1", "?hops=1"},
      {"udp:239.1.1.1:1?ttl=", "?ttl="},
      {"socketcan:", "interface \"\""},
      {"socketcan:sixteencharacter", "interface \"sixteencharacter\""},
      {"socketcan:a b", "interface \"a b\""},
  };
  for (const Bad& bad : kBad) {
    std::string error;
    EXPECT_FALSE(ParseBusName(bad.name, &error)) << bad.name;
    EXPECT_NE(error.find(std::string("bus name \"").append(bad.name).append("\": ")), std::string::npos)
        << error;
    EXPECT_NE(error.find(bad.problem), std::string::npos) << error;
    EXPECT_NE(error.find("allowed are udp:<group>:<port>"), std::string::npos) << error;
  }
}

TEST(OpenBus, SaysWhatToDoWithoutAnInterface) {
  std::string error;
  EXPECT_EQ(OpenBus("socketcan:nosuchcan", {}, MachineClock::Get(), &error), nullptr);
  EXPECT_NE(error.find("bus socketcan:nosuchcan"), std::string::npos) << error;
  EXPECT_NE(error.find("sudo "), std::string::npos) << error;
}

TEST(OpenBus, PassesOnWhatIsWrongWithAName) {
  std::string error;
  EXPECT_EQ(OpenBus("udp:1.2.3.4:5", {}, MachineClock::Get(), &error), nullptr);
  EXPECT_NE(error.find("1.2.3.4"), std::string::npos) << error;
}

}  // namespace
}  // namespace armada
