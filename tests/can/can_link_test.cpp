#include "firmware/can/can_link.h"

#include <gtest/gtest.h>

namespace armada {
namespace {

/// A controller as the default options want it.
CanLink Controller() {
  CanLink link;
  link.name = "can0";
  link.kind = "can";
  link.up = true;
  link.is_can = true;
  link.mtu = 16;
  link.tx_queue_length = 10;
  link.bitrate_bit_s = 1'000'000;
  return link;
}

/// The problem has this said of it, and the command that mends it.
void ExpectProblem(const CanLink& link, const BusOptions& options, const std::string& what,
                   const std::string& command) {
  const std::string problem = CheckCanLink(link, options);
  EXPECT_NE(problem.find("bus socketcan:can0"), std::string::npos) << problem;
  EXPECT_NE(problem.find(what), std::string::npos) << problem;
  EXPECT_NE(problem.find(command), std::string::npos) << problem;
}

TEST(CanLink, WhatFitsIsAccepted) {
  EXPECT_EQ(CheckCanLink(Controller(), {}), "");
  BusOptions fd;
  fd.fd = true;
  CanLink link = Controller();
  link.mtu = 72;
  link.data_bitrate_bit_s = 5'000'000;
  EXPECT_EQ(CheckCanLink(link, fd), "");
}

TEST(CanLink, VirtualInterfacesHaveNoBitTimingAndNoQueueToMind) {
  CanLink link = Controller();
  link.kind = "vcan";
  link.bitrate_bit_s = std::nullopt;
  link.tx_queue_length = 1000;
  EXPECT_EQ(CheckCanLink(link, {}), "");
}

TEST(CanLink, AnotherBitRateIsRefused) {
  CanLink link = Controller();
  link.bitrate_bit_s = 500'000;
  ExpectProblem(link, {}, "500000 bit/s, the fleet says 1000000",
                "sudo ip link set can0 type can bitrate 1000000");
}

TEST(CanLink, AnotherDataBitRateIsRefused) {
  CanLink link = Controller();
  link.mtu = 72;
  link.data_bitrate_bit_s = 2'000'000;
  BusOptions fd;
  fd.fd = true;
  ExpectProblem(link, fd, "2000000 bit/s, the fleet says 5000000", "dbitrate 5000000 fd on");
}

TEST(CanLink, ARestartByItselfIsRefused) {
  CanLink link = Controller();
  link.restart_ms = 100;
  ExpectProblem(link, {}, "restart-ms 100", "type can restart-ms 0");
}

TEST(CanLink, AQueueThatHoldsOldTorquesIsRefusedAndOneThatHoldsNone) {
  CanLink link = Controller();
  link.tx_queue_length = 1000;
  ExpectProblem(link, {}, "holds 1000 frames, allowed are 4 to 32", "txqueuelen 32");
  link.tx_queue_length = 1;
  ExpectProblem(link, {}, "holds 1 frames", "txqueuelen 32");
}

TEST(CanLink, AListenerADownLinkAndAnotherKindAreRefused) {
  CanLink link = Controller();
  link.listen_only = true;
  ExpectProblem(link, {}, "only listens", "listen-only off");
  link = Controller();
  link.up = false;
  ExpectProblem(link, {}, "it is down", "sudo ip link set can0 up");
  link = Controller();
  link.is_can = false;
  EXPECT_NE(CheckCanLink(link, {}).find("no CAN interface"), std::string::npos);
}

}  // namespace
}  // namespace armada
