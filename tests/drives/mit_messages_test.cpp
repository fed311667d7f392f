#include "firmware/can/mit_messages.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "firmware/can/damiao_messages.h"
#include "tests/can/frames.h"

namespace armada::mit {
namespace {

JointDriveConfig Joint(DriveProfile profile) {
  JointDriveConfig joint;
  joint.profile = profile;
  joint.node_id = 1;
  joint.torque_limit_Nm = 18.0;
  joint.mit = {.master_id = 0,
               .position_max_rad = 12.5,
               .velocity_max_rad_s = 65.0,
               .torque_max_Nm = 18.0,
               .kp_max_Nm_rad = 500.0,
               .kd_max_Nms_rad = 5.0};
  return joint;
}

const JointDriveConfig kMini = Joint(DriveProfile::kMiniCheetah);
const JointDriveConfig kDamiaoJoint = Joint(DriveProfile::kDamiao);
const JointDriveConfig kCube = Joint(DriveProfile::kCubeMars);

// What mini-cheetah's own tools put on the wire for "all zero", and what a controller answered on a bench:
// 001#7FFF7FF0000007FF, 000#017FFF7FF7FF.
TEST(MitMessages, ZeroTorqueIsTheFrameThatEveryMasterSends) {
  const CanFrame frame = EncodeTorque(kMini, kZeroTorqueCode);
  EXPECT_EQ(Describe(frame), Describe(DataFrame(0x001, {0x7F, 0xFF, 0x7F, 0xF0, 0x00, 0x00, 0x07, 0xFF})));
  EXPECT_TRUE(frame.latest_only);
}

TEST(MitMessages, ARecordedReplyIsReadAsItWasMeant) {
  const CanFrame frame = DataFrame(0x000, {0x01, 0x7F, 0xFF, 0x7F, 0xF7, 0xFF});
  ASSERT_TRUE(IsFromDrive(frame, kMini));
  Reply reply;
  ASSERT_TRUE(DecodeReply(frame, kMini, &reply));
  EXPECT_NEAR(reply.position_rad, -12.5 / 65535.0, 1e-12);
  EXPECT_NEAR(reply.velocity_rad_s, -65.0 / 4095.0, 1e-12);
  EXPECT_NEAR(reply.torque_Nm, -18.0 / 4095.0, 1e-12);
  EXPECT_EQ(Describe(EncodeReply(kMini, {})), Describe(frame)) << "an idle drive at its zero";
}

// CubeMars AK Series Actuator Driver Manual 1.0.8, 5.3 "Special Can code"; 0xFB: Damiao's manuals.
TEST(MitMessages, SpecialFramesAreThoseOfTheManual) {
  const auto expected = [](uint8_t last) {
    return Describe(DataFrame(0x001, {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, last}));
  };
  EXPECT_EQ(Describe(EncodeSpecial(kMini, Special::kEnable)), expected(0xFC));
  EXPECT_EQ(Describe(EncodeSpecial(kMini, Special::kDisable)), expected(0xFD));
  EXPECT_EQ(Describe(EncodeSpecial(kMini, Special::kSetZero)), expected(0xFE));
  EXPECT_EQ(Describe(EncodeSpecial(kMini, Special::kClearFault)), expected(0xFB));
  EXPECT_FALSE(EncodeSpecial(kMini, Special::kEnable).latest_only) << "must not be overtaken";
}

// Layout by unpack_cmd of the mini-cheetah firmware: p 0x1234, v 0x567, kp 0x89A, kd 0xBCD, t 0xEF0.
TEST(MitMessages, CommandFieldsLieWhereTheFirmwareReadsThem) {
  const CanFrame frame = DataFrame(0x001, {0x12, 0x34, 0x56, 0x78, 0x9A, 0xBC, 0xDE, 0xF0});
  ASSERT_TRUE(IsForDrive(frame, kMini));
  Special special{};
  EXPECT_FALSE(DecodeSpecial(frame, &special));
  const Command command = DecodeCommand(frame, kMini);
  EXPECT_NEAR(command.position_rad, 0x1234 * 25.0 / 65535.0 - 12.5, 1e-12);
  EXPECT_NEAR(command.velocity_rad_s, 0x567 * 130.0 / 4095.0 - 65.0, 1e-12);
  EXPECT_NEAR(command.kp_Nm_rad, 0x89A * 500.0 / 4095.0, 1e-12);
  EXPECT_NEAR(command.kd_Nms_rad, 0xBCD * 5.0 / 4095.0, 1e-12);
  EXPECT_NEAR(command.torque_Nm, 0xEF0 * 36.0 / 4095.0 - 18.0, 1e-12);
}

// Layout by pack_reply of the mini-cheetah firmware, and "MIT power mode driver board sending data
// definition" of the CubeMars manual: id, p 0x1234, v 0x567, t 0x89A, temperature 40, error 3.
TEST(MitMessages, ReplyFieldsLieWhereTheFirmwareWritesThem) {
  const CanFrame frame = DataFrame(0x000, {0x01, 0x12, 0x34, 0x56, 0x78, 0x9A, 40, 3});
  Reply reply;
  ASSERT_TRUE(DecodeReply(frame, kCube, &reply));
  EXPECT_NEAR(reply.position_rad, 0x1234 * 25.0 / 65535.0 - 12.5, 1e-12);
  EXPECT_NEAR(reply.velocity_rad_s, 0x567 * 130.0 / 4095.0 - 65.0, 1e-12);
  EXPECT_NEAR(reply.torque_Nm, 0x89A * 36.0 / 4095.0 - 18.0, 1e-12);
  EXPECT_EQ(reply.status, 3);
  EXPECT_EQ(PositionCode(frame), 0x1234u);
  ASSERT_TRUE(DecodeReply(frame, kMini, &reply)) << "what follows six bytes is no business of a mini-cheetah";
  EXPECT_EQ(reply.status, 0);
}

// Damiao's manuals: byte 0 is node | status << 4; 0xD is "communication lost".
TEST(MitMessages, DamiaoRepliesTellStatusAndNodeInOneByte) {
  const CanFrame frame = DataFrame(0x000, {0xD1, 0x7F, 0xFF, 0x7F, 0xF7, 0xFF, 40, 35});
  ASSERT_TRUE(IsFromDrive(frame, kDamiaoJoint));
  Reply reply;
  ASSERT_TRUE(DecodeReply(frame, kDamiaoJoint, &reply));
  EXPECT_EQ(reply.status, damiao::kCommunicationLost);
  EXPECT_STREQ(damiao::StatusName(0xD), "communication lost");
  EXPECT_STREQ(damiao::StatusName(0x8), "over voltage");
  EXPECT_STREQ(damiao::StatusName(0xE), "overload");
  EXPECT_FALSE(IsFromDrive(frame, kMini)) << "others have eight bits for the node";
}

TEST(MitMessages, EveryTorqueCodeComesBackFromItsTorque) {
  for (const double max_Nm : {18.0, 25.0, 144.0, 0.1, 7.3}) {
    JointDriveConfig joint = kMini;
    joint.mit.torque_max_Nm = max_Nm;
    for (uint32_t code = 0; code < 4096; ++code) {
      const double torque_Nm = DecodeCommand(EncodeTorque(joint, code), joint).torque_Nm;
      ASSERT_NEAR(torque_Nm, code * 2.0 * max_Nm / 4095.0 - max_Nm, 1e-12 * max_Nm);
      ASSERT_EQ(TorqueCode(joint.mit, torque_Nm, max_Nm), code);
    }
  }
}

TEST(MitMessages, ATorqueIsRoundedToTheNearestCodeButNeverPastItsLimit) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const double step_Nm = TorqueStep_Nm(kMini.mit);
  EXPECT_NEAR(step_Nm, 36.0 / 4095.0, 1e-15);
  for (int i = 0; i < 100'000; ++i) {
    const double limit_Nm = 0.01 + 20.0 * std::abs(unit(random));
    const double tau_Nm = 25.0 * unit(random);
    const double sent_Nm =
        DecodeCommand(EncodeTorque(kMini, TorqueCode(kMini.mit, tau_Nm, limit_Nm)), kMini).torque_Nm;
    ASSERT_LE(std::abs(sent_Nm), limit_Nm + 1e-12) << tau_Nm;
    if (std::abs(tau_Nm) <= std::min(limit_Nm, 18.0) - step_Nm) {
      ASSERT_LE(std::abs(sent_Nm - tau_Nm), 0.5 * step_Nm + 1e-12);
    }
  }
}

TEST(MitMessages, ZeroIsHalfAStepOffAndAlwaysTheSameCode) {
  for (const double limit_Nm : {18.0, 1.0, 0.0044, 1e-9}) {
    EXPECT_EQ(TorqueCode(kMini.mit, 0.0, limit_Nm), kZeroTorqueCode) << limit_Nm;
    EXPECT_EQ(TorqueCode(kMini.mit, -0.0, limit_Nm), kZeroTorqueCode);
  }
  EXPECT_EQ(TorqueCode(kMini.mit, 1e-9, 18.0), 0x800u);
  EXPECT_EQ(TorqueCode(kMini.mit, -1e-9, 18.0), 0x7FFu);
  EXPECT_EQ(TorqueCode(kMini.mit, 1e308, 18.0), 0xFFFu);
  EXPECT_EQ(TorqueCode(kMini.mit, -1e308, 18.0), 0x000u);
}

TEST(MitMessages, EveryPositionCodeIsReadToItsPlace) {
  for (uint32_t code = 0; code <= 0xFFFF; ++code) {
    const CanFrame frame =
        DataFrame(0, {1, static_cast<uint8_t>(code >> 8), static_cast<uint8_t>(code), 0, 0, 0});
    Reply reply;
    ASSERT_TRUE(DecodeReply(frame, kMini, &reply));
    ASSERT_NEAR(reply.position_rad, code * 25.0 / 65535.0 - 12.5, 1e-11);
    ASSERT_EQ(PositionCode(frame), code);
  }
}

TEST(MitMessages, APositionOutOfRangeGoesOnAtTheOtherEndAsInTheFirmware) {
  Reply reply{.position_rad = 12.5 + 25.0 / 65535.0 * 10.5};
  EXPECT_EQ(PositionCode(EncodeReply(kMini, reply)), 9u);
  reply.position_rad = -12.5 - 25.0 / 65535.0 * 10.5;
  EXPECT_EQ(PositionCode(EncodeReply(kMini, reply)), 0x10000u - 10u);
}

TEST(MitMessages, FramesOfOthersOrOfTheWrongLengthAreNotTaken) {
  const CanFrame good = DataFrame(0, {1, 0x80, 0, 0x80, 0x08, 0, 25, 0});
  ASSERT_TRUE(IsFromDrive(good, kCube));
  const auto refused = [&](auto change) {
    CanFrame frame = good;
    change(frame);
    Reply reply{.position_rad = 7.0};
    return (!IsFromDrive(frame, kCube) || !DecodeReply(frame, kCube, &reply)) && reply.position_rad == 7.0;
  };
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.id = 1; }));
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.data[0] = 2; }));
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.extended = true; }));
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.remote = true; }));
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.error = true; }));
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.fd = true; }));
  for (uint8_t length = 0; length < 8; ++length) {
    EXPECT_TRUE(refused([length](CanFrame& frame) { frame.length = length; })) << int{length};
  }
}

TEST(MitMessages, TheTablesAreTheCodec) {
  for (const JointDriveConfig& joint : {kMini, kCube, kDamiaoJoint}) {
    const std::vector<CanMessage> messages = Messages(joint);
    const CanMessage& state = messages.back();
    EXPECT_EQ(state.id, 0u);
    EXPECT_TRUE(state.from_drive);
    const CanFrame frame = EncodeReply(joint, {.position_rad = 1.0, .velocity_rad_s = -2.0, .status = 3});
    EXPECT_EQ(state.length, frame.length);
    EXPECT_EQ(GetRaw(frame, state.signals[static_cast<size_t>(state.multiplexor)]), state.multiplexor_raw);
    EXPECT_NEAR(GetPhysical(frame, state.signals[1]), 1.0, 25.0 / 65535.0);
    EXPECT_NEAR(GetPhysical(frame, state.signals[2]), -2.0, 130.0 / 4095.0);
    for (const CanMessage& message : messages) {
      for (const CanSignal& signal : message.signals) EXPECT_LE(signal.start_bit / 8, message.length - 1);
    }
  }
  const CanFrame enable = EncodeSpecial(kMini, Special::kEnable);
  const CanMessage first = Messages(kMini).front();
  EXPECT_STREQ(first.name, "Enable");
  EXPECT_EQ(GetRaw(enable, first.signals[0]), first.multiplexor_raw);
  EXPECT_NE(GetRaw(EncodeTorque(kMini, 0xFFF), first.signals[0]), first.multiplexor_raw);
}

}  // namespace
}  // namespace armada::mit
