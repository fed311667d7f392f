#include "firmware/can/odrive_messages.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "tests/can/frames.h"

namespace armada::odrive {
namespace {

// Bytes worked out from the layouts of the vendor's documents, floats from IEEE 754.
constexpr int kNode = 5;  // identifiers 0xA0 to 0xBF

TEST(ODriveMessages, HaveTheDocumentedBytes) {
  EXPECT_EQ(Describe(EncodeSetAxisState(kNode, AxisState::kClosedLoop)),
            Describe(DataFrame(0xA7, {8, 0, 0, 0})));
  EXPECT_EQ(Describe(EncodeSetAxisState(kNode, AxisState::kIdle)), Describe(DataFrame(0xA7, {1, 0, 0, 0})));
  EXPECT_EQ(Describe(EncodeSetControllerMode(kNode, {ControlMode::kTorque, InputMode::kPassthrough})),
            Describe(DataFrame(0xAB, {1, 0, 0, 0, 1, 0, 0, 0})));
  EXPECT_EQ(Describe(EncodeSetInputTorque(kNode, -2.5f)),
            Describe(DataFrame(0xAE, {0x00, 0x00, 0x20, 0xC0})));
  EXPECT_EQ(Describe(EncodeEncoderEstimates(kNode, {1.0f, -2.5f})),
            Describe(DataFrame(0xA9, {0x00, 0x00, 0x80, 0x3F, 0x00, 0x00, 0x20, 0xC0})));
  EXPECT_EQ(Describe(EncodeClearErrors(kNode)), Describe(DataFrame(0xB8, {0})));
  EXPECT_EQ(Describe(EncodeEstop(kNode)), Describe(DataFrame(0xA2, {})));
  EXPECT_EQ(Describe(EncodeEncoderRequest(kNode)), "169 0 1 0 0 0 0 8 -");
}

TEST(ODriveMessages, HeartbeatsHaveTheBytesOfTheirGeneration) {
  EXPECT_EQ(Describe(EncodeHeartbeat(kNode, Firmware::kV06, {0x0100'0000, AxisState::kIdle, 3})),
            Describe(DataFrame(0xA1, {0, 0, 0, 1, 1, 3, 0, 0})));
  EXPECT_EQ(Describe(EncodeHeartbeat(kNode, Firmware::kV06, {0, AxisState::kClosedLoop, 1})),
            Describe(DataFrame(0xA1, {0, 0, 0, 0, 8, 1, 0, 0})));
  EXPECT_EQ(Describe(EncodeHeartbeat(kNode, Firmware::kV05, {0x0940, AxisState::kIdle, 0})),
            Describe(DataFrame(0xA1, {0x40, 0x09, 0, 0, 1, 1, 1, 0})));
}

TEST(ODriveMessages, V05FlagsAreErrorsEvenWhenTheErrorFieldIsZero) {
  Heartbeat heartbeat;
  ASSERT_TRUE(DecodeHeartbeat(DataFrame(0xA1, {0, 0, 0, 0, 8, 0, 0, 1}), kNode, Firmware::kV05, &heartbeat));
  EXPECT_EQ(heartbeat.error, 0x200u) << "controller failed";
  ASSERT_TRUE(DecodeHeartbeat(DataFrame(0xA1, {0, 0, 0, 0, 8, 1, 1, 0}), kNode, Firmware::kV05, &heartbeat));
  EXPECT_EQ(heartbeat.error, 0x140u) << "motor and encoder failed";
}

TEST(ODriveMessages, TrajectoryDoneAndProcedureResultAreNoErrors) {
  Heartbeat heartbeat;
  ASSERT_TRUE(
      DecodeHeartbeat(DataFrame(0xA1, {0, 0, 0, 0, 8, 0, 0, 0x80}), kNode, Firmware::kV05, &heartbeat));
  EXPECT_EQ(heartbeat.error, 0u);
  EXPECT_EQ(heartbeat.state, AxisState::kClosedLoop);
  ASSERT_TRUE(DecodeHeartbeat(DataFrame(0xA1, {0, 0, 0, 0, 8, 1, 1, 0}), kNode, Firmware::kV06, &heartbeat));
  EXPECT_EQ(heartbeat.error, 0u);
  EXPECT_EQ(heartbeat.procedure_result, 1);
}

TEST(ODriveMessages, WhatOneSideWritesTheOtherReads) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<float> value(-1e6f, 1e6f);
  for (int i = 0; i < 2000; ++i) {
    const int node = static_cast<int>(random() % 64);
    const EncoderEstimates estimates{value(random), value(random)};
    EncoderEstimates read_estimates;
    ASSERT_TRUE(DecodeEncoderEstimates(EncodeEncoderEstimates(node, estimates), node, &read_estimates));
    ASSERT_EQ(read_estimates.position_turns, estimates.position_turns);
    ASSERT_EQ(read_estimates.velocity_turns_s, estimates.velocity_turns_s);

    const float torque_Nm = value(random);
    float read_torque_Nm = 0.0f;
    ASSERT_TRUE(DecodeSetInputTorque(EncodeSetInputTorque(node, torque_Nm), node, &read_torque_Nm));
    ASSERT_EQ(read_torque_Nm, torque_Nm);

    const auto state = static_cast<AxisState>(random() % 15);
    AxisState read_state{};
    ASSERT_TRUE(DecodeSetAxisState(EncodeSetAxisState(node, state), node, &read_state));
    ASSERT_EQ(read_state, state);

    const ControllerMode mode{static_cast<ControlMode>(random() % 4), static_cast<InputMode>(random() % 8)};
    ControllerMode read_mode;
    ASSERT_TRUE(DecodeSetControllerMode(EncodeSetControllerMode(node, mode), node, &read_mode));
    ASSERT_EQ(read_mode.control, mode.control);
    ASSERT_EQ(read_mode.input, mode.input);

    const Heartbeat heartbeat{static_cast<uint32_t>(random()), state, static_cast<uint8_t>(random())};
    for (const Firmware firmware : {Firmware::kV05, Firmware::kV06}) {
      Heartbeat read;
      ASSERT_TRUE(DecodeHeartbeat(EncodeHeartbeat(node, firmware, heartbeat), node, firmware, &read));
      ASSERT_EQ(read.error, heartbeat.error);
      ASSERT_EQ(read.state, heartbeat.state);
      ASSERT_EQ(read.procedure_result, firmware == Firmware::kV06 ? heartbeat.procedure_result : 0);
    }
  }
}

TEST(ODriveMessages, FramesOfAnotherNodeKindOrLengthAreRefused) {
  const CanFrame good = EncodeEncoderEstimates(kNode, {1.0f, 2.0f});
  EncoderEstimates estimates;
  ASSERT_TRUE(DecodeEncoderEstimates(good, kNode, &estimates));
  const auto refused = [&](auto change) {
    CanFrame frame = good;
    change(frame);
    EncoderEstimates untouched{7.0f, 8.0f};
    return !DecodeEncoderEstimates(frame, kNode, &untouched) && untouched.position_turns == 7.0f;
  };
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.id += 0x20; })) << "node";
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.id += 1; })) << "command";
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.id |= 0x800, frame.extended = true; })) << "extended";
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.extended = true; }));
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.remote = true; })) << "a request, perhaps our own";
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.error = true; }));
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.fd = true; }));
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.length = 7; }));
  EXPECT_TRUE(refused([](CanFrame& frame) { frame.length = 0; }));
}

TEST(ODriveMessages, NumbersThatAreNotFiniteAreRefused) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    EncoderEstimates estimates;
    EXPECT_FALSE(DecodeEncoderEstimates(EncodeEncoderEstimates(kNode, {bad, 0.0f}), kNode, &estimates));
    EXPECT_FALSE(DecodeEncoderEstimates(EncodeEncoderEstimates(kNode, {0.0f, -bad}), kNode, &estimates));
    float torque_Nm = 0.0f;
    EXPECT_FALSE(DecodeSetInputTorque(EncodeSetInputTorque(kNode, bad), kNode, &torque_Nm));
  }
}

}  // namespace
}  // namespace armada::odrive
