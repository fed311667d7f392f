#include "host/run/run_reservation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace armada {
namespace {

// Of this test and this process alone.
std::string Name(const std::string& name) {
  return "test " + std::to_string(getpid()) + " " + name;
}

TEST(RunReservationTest, WhatAnotherRunHasIsNamedWithItsProcess) {
  std::string taken;
  RunReservation first;
  ASSERT_TRUE(first.Take({Name("lcm"), Name("can1")}, &taken)) << taken;
  RunReservation second;
  EXPECT_FALSE(second.Take({Name("other"), Name("can1")}, &taken));
  EXPECT_EQ(taken, Name("can1") + " is in use by another run (process " + std::to_string(getpid()) + ")");
}

TEST(RunReservationTest, OneThatFailsHoldsNothingAndOneThatEndsFreesAll) {
  std::string taken;
  RunReservation third;
  {
    RunReservation first;
    ASSERT_TRUE(first.Take({Name("lcm")}, &taken)) << taken;
    RunReservation second;
    ASSERT_FALSE(second.Take({Name("other"), Name("lcm")}, &taken));
    EXPECT_TRUE(third.Take({Name("other")}, &taken)) << taken;
  }
  EXPECT_TRUE(third.Take({Name("lcm"), Name("other")}, &taken)) << taken;
}

FleetConfig FleetOn(const char* lcm_url, const char* first_bus, const char* second_bus) {
  FleetConfig fleet;
  fleet.link.lcm_url = lcm_url;
  fleet.arms.resize(2);
  fleet.arms[0].bus = first_bus;
  fleet.arms[1].bus = second_bus;
  return fleet;
}

TEST(RunReservationTest, ARunReservesItsNetworkAndEveryBusOnce) {
  const FleetConfig fleet =
      FleetOn("udpm://239.255.76.67:7667?ttl=0", "socketcan:can0", "udp:239.74.163.2:43113");
  EXPECT_THAT(NamesToReserve(fleet, {"1=socketcan:can1", "2=socketcan:can0"}),
              testing::ElementsAre("udpm://239.255.76.67:7667", "socketcan:can0", "udp:239.74.163.2:43113",
                                   "socketcan:can1"));
}

TEST(RunReservationTest, APlaceIsOneHoweverItIsSpelt) {
  const FleetConfig fleet =
      FleetOn("udpm://239.255.76.67:07667?ttl=0", "udp:239.74.163.2:43113?ttl=0", "udp:239.74.163.2:043113");
  EXPECT_THAT(NamesToReserve(fleet, {}),
              testing::ElementsAre("udpm://239.255.76.67:7667", "udp:239.74.163.2:43113"));
}

}  // namespace
}  // namespace armada
