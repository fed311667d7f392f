#include "firmware/can/moteus_messages.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "hil/moteus_emulator.h"
#include "tests/can/frames.h"

namespace armada::moteus {
namespace {

JointDriveConfig Joint(int node = 1) {
  JointDriveConfig joint;
  joint.profile = DriveProfile::kMoteus;
  joint.node_id = node;
  joint.torque_limit_Nm = 10.0;
  joint.watchdog_s = 2.0;
  return joint;
}

CanFrame FdFrame(uint32_t id, const std::string& hex) {
  CanFrame frame = EmptyFrame(id);
  for (const uint8_t byte : FromHex(hex)) frame.data[frame.length++] = byte;
  return frame;
}

// docs/protocol/can.md: 0x8001 is "from source 0, to destination 1, a reply is requested", 0x100 "from source
// 1 to destination 0, no reply".
TEST(MoteusMessages, IdentifiersAreThoseOfTheManual) {
  EXPECT_EQ(RequestId(0, 1, true), 0x8001u);
  EXPECT_EQ(RequestId(1, 0, false), 0x0100u);
  EXPECT_EQ(AnswerId(0, 1), 0x0100u);
  EXPECT_TRUE(EncodeStateQuery(Joint()).extended) << "more than 11 bits";
  EXPECT_FALSE(EncodeStop(Joint()).extended);
  EXPECT_TRUE(EncodeStateQuery(Joint()).fd);
  EXPECT_TRUE(EncodeStateQuery(Joint()).bitrate_switch);
}

// The layout by docs/protocol/can.md; NaN and the subframe of register 0x027 as in a frame of the mjbots
// tools, "can send 8001 01000A 0D200000C07F 0D2700000040 ...": watchdog of 2 s.
TEST(MoteusMessages, ATorqueHasTheBytesOfItsSubframes) {
  const CanFrame frame = EncodeTorque(Joint(), -1.5f);
  EXPECT_EQ(Describe(frame), Describe(FdFrame(0x0001,
                                              "01000a"
                                              "0c0520"
                                              "0000c07f"
                                              "00000000"
                                              "0000c0bf"
                                              "00000000"
                                              "00000000"
                                              "0d2700000040")));
  EXPECT_EQ(frame.length, 32);
  EXPECT_TRUE(frame.latest_only);
  EXPECT_TRUE(IsValid(frame));
}

TEST(MoteusMessages, QueriesAndStopHaveTheBytesOfTheirSubframes) {
  EXPECT_EQ(Describe(EncodeStop(Joint())), Describe(FdFrame(0x0001, "010000")));
  EXPECT_FALSE(EncodeStop(Joint()).latest_only) << "must not be overtaken by a torque";
  EXPECT_EQ(Describe(EncodeStateQuery(Joint())), Describe(FdFrame(0x8001, "11001f01110f")));
  EXPECT_EQ(Describe(EncodeSetupQuery(Joint())), Describe(FdFrame(0x8001, "11001f01110f1d2719820250")))
      << "0x102 as a varuint is 82 02; padding 50";
}

// 0.25 turns, -2.5 turns/s, 1 N m; IEEE 754 by hand.
TEST(MoteusMessages, AStateIsReadFromItsBytes) {
  const CanFrame frame = FdFrame(0x0100, "21000a2f010000803e000020c00000803f210f66");
  ASSERT_TRUE(IsFromDrive(frame, Joint()));
  State state;
  ASSERT_TRUE(DecodeState(frame, &state));
  EXPECT_EQ(state.mode, Mode::kPosition);
  EXPECT_EQ(state.position_turns, 0.25f);
  EXPECT_EQ(state.velocity_turns_s, -2.5f);
  EXPECT_EQ(state.torque_Nm, 1.0f);
  EXPECT_EQ(state.fault, 102) << "the commanded maximum torque limits: no fault";
}

TEST(MoteusMessages, WhatIsNotThatAnswerIsRefused) {
  const CanFrame good = FdFrame(0x0100, "21000a2f010000803e000020c00000803f210f00");
  const auto refused = [&](auto change) {
    CanFrame frame = good;
    change(frame);
    State state;
    state.fault = 7;
    return !DecodeState(frame, &state) && state.fault == 7;
  };
  for (const unsigned constant : {0u, 1u, 3u, 4u, 17u, 18u}) {
    EXPECT_TRUE(refused([&](CanFrame& frame) { frame.data[constant] ^= 1; })) << constant;
  }
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.length = 16; }));
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.length = 24; }));
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.fd = false; }));
  for (const unsigned number : {5u, 9u, 13u}) {
    EXPECT_TRUE(refused([&](CanFrame& frame) { std::memcpy(&frame.data[number], "\x00\x00\xC0\x7F", 4); }))
        << "NaN";
    EXPECT_TRUE(refused([&](CanFrame& frame) { std::memcpy(&frame.data[number], "\x00\x00\x80\xFF", 4); }))
        << "infinite";
  }
}

TEST(MoteusMessages, FaultsHaveTheirNames) {
  EXPECT_STREQ(FaultName(33), "motor driver fault");
  EXPECT_STREQ(FaultName(40), "under voltage");
  EXPECT_STREQ(FaultName(48), "invalid limits");
  EXPECT_STREQ(FaultName(49), "unknown");
  EXPECT_STREQ(FaultName(0), "unknown");
}

// The worked example of docs/protocol/can.md, bytes and meaning.
TEST(MoteusSubframes, TheCommandOfTheManualsExampleIsReadAsItSays) {
  const CanFrame frame = FdFrame(0x8001, "01000a07206000200150ff140400130d");
  MoteusReader reader(frame);
  EXPECT_EQ(reader.Varuint(), 0x01u);
  EXPECT_EQ(reader.Varuint(), 0x00u);
  EXPECT_EQ(reader.Value(MoteusType::kInt8, Register::kMode), 10.0);
  EXPECT_EQ(reader.Varuint(), 0x07u);
  EXPECT_EQ(reader.Varuint(), 0x20u);
  EXPECT_NEAR(*reader.Value(MoteusType::kInt16, Register::kCommandPosition) * 360.0, 3.456, 1e-9);
  EXPECT_NEAR(*reader.Value(MoteusType::kInt16, Register::kCommandVelocity) * 360.0, 25.92, 1e-9);
  EXPECT_NEAR(*reader.Value(MoteusType::kInt16, Register::kCommandTorque), -1.76, 1e-9);
}

TEST(MoteusSubframes, TheEmulatedControllerAnswersAsTheManualsExample) {
  constexpr double kRadPerTurn = 6.283185307179586;
  const JointTruth truth{0.00804 * kRadPerTurn, 0.06405 * kRadPerTurn};  // 2.88 and 23.04 degrees (/s)
  MoteusEmulator drive(Joint(), EmulatedDriveConfig{}, 1);
  FrameList out;
  drive.OnFrame(1.0, EncodeTorque(Joint(), -1.444f), truth, &out);
  drive.OnTime(1.02, truth, &out);
  ASSERT_EQ(out.size(), 0u) << "nobody asked";
  drive.OnFrame(1.03, FdFrame(0x8001, "140400130d"), truth, &out);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_EQ(Describe(out[0]), Describe(FdFrame(0x0100, "2404000a005000000170ff230d181400")));
}

TEST(MoteusSubframes, IntegersSaturateAndTheSmallestMeansNaN) {
  for (const auto type : {MoteusType::kInt8, MoteusType::kInt16, MoteusType::kInt32}) {
    for (const double value : {std::nan(""), 1e30, -1e30}) {
      CanFrame frame = EmptyFrame(1);
      MoteusWriter(&frame).Value(type, Register::kPosition, value);
      const std::optional<double> back = MoteusReader(frame).Value(type, Register::kPosition);
      ASSERT_TRUE(back);
      if (std::isnan(value)) {
        EXPECT_TRUE(std::isnan(*back));
      } else {
        EXPECT_GT(*back * value, 0.0);
        EXPECT_TRUE(std::isfinite(*back));
      }
    }
  }
}

TEST(MoteusSubframes, RegistersThatAreNotThereAreErrorsOfTheProtocol) {
  MoteusEmulator drive(Joint(), EmulatedDriveConfig{}, 1);
  FrameList out;
  drive.OnFrame(1.0, FdFrame(0x8001, "1168"), {}, &out);
  drive.OnFrame(1.0, FdFrame(0x8001, "016801"), {}, &out);
  drive.OnFrame(1.0, FdFrame(0x8001, "010d01"), {}, &out);
  ASSERT_EQ(out.size(), 3u);
  EXPECT_EQ(Describe(out[0]), Describe(FdFrame(0x0100, "316801"))) << "read error, unknown register";
  EXPECT_EQ(Describe(out[1]), Describe(FdFrame(0x0100, "306801"))) << "write error, unknown register";
  EXPECT_EQ(Describe(out[2]), Describe(FdFrame(0x0100, "300d02"))) << "write error, not writeable";
}

TEST(MoteusMessages, TheTablesAreTheCodec) {
  const JointDriveConfig joint = Joint(9);
  const std::vector<CanMessage> messages = Messages(joint);
  const auto message_of = [&](const CanFrame& frame) -> std::string {
    for (const CanMessage& message : messages) {
      if (message.id != frame.id || message.extended != frame.extended) continue;
      if (message.multiplexor >= 0 &&
          GetRaw(frame, message.signals[static_cast<size_t>(message.multiplexor)]) !=
              message.multiplexor_raw) {
        continue;
      }
      EXPECT_EQ(message.length, frame.length) << message.name;
      return message.name;
    }
    return "";
  };
  EXPECT_EQ(message_of(EncodeStop(joint)), "Stop");
  EXPECT_EQ(message_of(EncodeTorque(joint, 2.5f)), "Torque");
  EXPECT_EQ(message_of(EncodeStateQuery(joint)), "StateQuery");
  EXPECT_EQ(message_of(EncodeSetupQuery(joint)), "SetupQuery");
  MoteusEmulator drive(joint, EmulatedDriveConfig{}, 1);
  FrameList out;
  drive.OnFrame(1.0, EncodeStateQuery(joint), {}, &out);
  drive.OnFrame(1.0, EncodeSetupQuery(joint), {}, &out);
  ASSERT_EQ(out.size(), 2u);
  EXPECT_EQ(message_of(out[0]), "State");
  EXPECT_EQ(message_of(out[1]), "Setup");
  EXPECT_EQ(GetPhysical(EncodeTorque(joint, 2.5f), messages[1].signals[3]), 2.5);
  EXPECT_EQ(GetPhysical(EncodeTorque(joint, 2.5f), messages[1].signals[6]), 2.0) << "watchdog";
}

}  // namespace
}  // namespace armada::moteus
