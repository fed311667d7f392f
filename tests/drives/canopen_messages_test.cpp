#include "firmware/can/canopen_messages.h"

#include <gtest/gtest.h>

#include <string>

#include "firmware/can/canopen_sdo.h"
#include "tests/drives/cia402_bytes.h"

namespace armada {
namespace {

using canopen::Emergency;
using canopen::NmtCommand;
using canopen::NmtState;
using canopen::Sdo;
using canopen::SdoAbort;
using canopen::SdoKind;

// EAO series 09 keypad manual, p. 51: boot sequence of node 0Bh.
TEST(CanopenMessages, NmtAndHeartbeatHaveTheBytesOfAVendorsBootSequence) {
  EXPECT_EQ(Text(canopen::EncodeHeartbeat(0x0B, NmtState::kBootUp)), "70B#00");
  EXPECT_EQ(Text(canopen::EncodeHeartbeat(0x0B, NmtState::kPreOperational)), "70B#7F");
  EXPECT_EQ(Text(canopen::EncodeNmt(NmtCommand::kStart, 0x0B)), "000#010B");
  EXPECT_EQ(Text(canopen::EncodeHeartbeat(0x0B, NmtState::kOperational)), "70B#05");
  NmtState state{};
  ASSERT_TRUE(canopen::DecodeHeartbeat(Frame("70B#7F"), 0x0B, &state));
  EXPECT_EQ(state, NmtState::kPreOperational);
}

TEST(CanopenMessages, NmtCommandsAreThoseOfCia301) {
  EXPECT_EQ(Text(canopen::EncodeNmt(NmtCommand::kStop, 3)), "000#0203");
  EXPECT_EQ(Text(canopen::EncodeNmt(NmtCommand::kPreOperational, 3)), "000#8003");
  EXPECT_EQ(Text(canopen::EncodeNmt(NmtCommand::kResetNode, 3)), "000#8103");
  EXPECT_EQ(Text(canopen::EncodeNmt(NmtCommand::kResetCommunication, 127)), "000#827F");
  EXPECT_EQ(Text(canopen::EncodeSync()), "080#");
}

// Faulhaber MC 5010 communications manual (7000.05050), table 10: following error.
TEST(CanopenMessages, AnEmergencyOfAVendorsManualIsRead) {
  Emergency emergency;
  ASSERT_TRUE(canopen::DecodeEmergency(Frame("085#1186200200000000"), 5, &emergency));
  EXPECT_EQ(emergency.error_code, 0x8611);
  EXPECT_EQ(emergency.error_register, 0x20);
  EXPECT_EQ(Text(canopen::EncodeEmergency(5, {0x8130, 0x11})), "085#3081110000000000");
}

// Festo, CiA 402 manual for CMMS/CMMD (GDCP-CMMS/D-C-CO-EN 1404NH), p. 20; Applied Motion CANopen manual
// 920-0025 rev. K, p. 91; Bonfiglioli CM-CAN ACU 04/13, p. 79; ICP DAS CAN-8x23 manual rev. 3.20, p. 136.
TEST(CanopenSdo, RequestsHaveTheBytesOfVendorsManuals) {
  EXPECT_EQ(Text(canopen::EncodeSdoUpload(1, {0x6061, 0})), "601#4061600000000000");
  EXPECT_EQ(Text(canopen::EncodeSdoUpload(0x2E, {0x1017, 0})), "62E#4017100000000000");
  EXPECT_EQ(Text(canopen::EncodeSdoDownload(1, {0x1401, 2}, 1, 0xEF)), "601#2F011402EF000000");
  EXPECT_EQ(Text(canopen::EncodeSdoDownload(1, {0x6040, 0}, 2, 0x03E8)), "601#2B406000E8030000");
  EXPECT_EQ(Text(canopen::EncodeSdoDownload(1, {0x6093, 1}, 4, 0x12345678)), "601#2393600178563412");
  EXPECT_EQ(Text(canopen::EncodeSdoDownload(1, {0x1405, 1}, 4, 0x0202)), "601#2305140102020000");
}

TEST(CanopenSdo, RepliesOfVendorsManualsAreRead) {
  Sdo sdo;
  ASSERT_TRUE(canopen::DecodeSdoReply(Frame("581#4F61600001000000"), 1, &sdo));
  EXPECT_EQ(sdo.kind, SdoKind::kUpload);
  EXPECT_EQ(sdo.entry, (canopen::Entry{0x6061, 0}));
  EXPECT_EQ(sdo.bytes, 1);
  EXPECT_EQ(sdo.value, 1u);
  ASSERT_TRUE(canopen::DecodeSdoReply(Frame("581#4B41600034120000"), 1, &sdo));
  EXPECT_EQ(sdo.bytes, 2);
  EXPECT_EQ(sdo.value, 0x1234u);
  ASSERT_TRUE(canopen::DecodeSdoReply(Frame("581#43E0210318FCFFFF"), 1, &sdo));
  EXPECT_EQ(sdo.bytes, 4);
  EXPECT_EQ(static_cast<int32_t>(sdo.value), -1000);
  ASSERT_TRUE(canopen::DecodeSdoReply(Frame("581#6005140100000000"), 1, &sdo));
  EXPECT_EQ(sdo.kind, SdoKind::kDownload);
  EXPECT_EQ(sdo.entry, (canopen::Entry{0x1405, 1}));
  // A string of nine characters: not what an expedited transfer holds.
  ASSERT_TRUE(canopen::DecodeSdoReply(Frame("581#410C210009000000"), 1, &sdo));
  EXPECT_EQ(sdo.kind, SdoKind::kOther);
}

TEST(CanopenSdo, AnAbortTellsItsReason) {
  Sdo sdo;
  ASSERT_TRUE(canopen::DecodeSdoReply(Frame("581#8060600000000206"), 1, &sdo));
  EXPECT_EQ(sdo.kind, SdoKind::kAbort);
  EXPECT_EQ(sdo.value, 0x06020000u);
  EXPECT_STREQ(canopen::TextOf(static_cast<SdoAbort>(sdo.value)), "object does not exist");
  EXPECT_STREQ(canopen::TextOf(static_cast<SdoAbort>(0x12345678)), "reason unknown");
}

TEST(CanopenMessages, WhatIsNoSuchMessageIsNotRead) {
  NmtState state{};
  for (const char* frame : {"70B#", "70B#0500", "70B#06", "70C#05", "0000070B#05", "70B#R"}) {
    EXPECT_FALSE(canopen::DecodeHeartbeat(Frame(frame), 0x0B, &state)) << frame;
  }
  NmtCommand command{};
  int node = 0;
  for (const char* frame : {"000#01", "000#0301", "001#0101"}) {
    EXPECT_FALSE(canopen::DecodeNmt(Frame(frame), &command, &node)) << frame;
  }
  Emergency emergency;
  EXPECT_FALSE(canopen::DecodeEmergency(Frame("085#118620"), 5, &emergency));
  Sdo sdo;
  EXPECT_FALSE(canopen::DecodeSdoReply(Frame("581#4F61600001"), 1, &sdo));
  EXPECT_FALSE(canopen::DecodeSdoRequest(Frame("581#4061600000000000"), 1, &sdo));
}

}  // namespace
}  // namespace armada
