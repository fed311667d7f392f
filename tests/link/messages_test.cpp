#include "firmware/link/messages.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <string>
#include <vector>

#include "firmware/core/types.h"
#include "tests/link/golden_bytes.h"
#include "tests/link/golden_messages.h"
#include "tests/support/hex.h"

namespace armada {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <class Message>
bool IsAccepted(const Message& message) {
  MessageBuffer buffer;
  Message decoded;
  return Decode(Encode(message, &buffer), &decoded);
}

// Whether the message stays acceptable after `change`.
template <class Message, class Change>
bool IsAcceptedAfter(Message message, Change change) {
  change(message);
  return IsAccepted(message);
}

TEST(Messages, EncodeToTheBytesOfAnIndependentCodec) {
  MessageBuffer buffer;
  EXPECT_EQ(Hex(Encode(GoldenLeader(), &buffer)), kLeaderHex);
  EXPECT_EQ(Hex(Encode(GoldenEstimate(), &buffer)), kEstimateHex);
  EXPECT_EQ(Hex(Encode(GoldenTelemetry(), &buffer)), kTelemetryHex);
  EXPECT_EQ(Hex(Encode(GoldenCommand(), &buffer)), kCommandHex);
  EXPECT_EQ(Hex(Encode(GoldenReply(), &buffer)), kReplyHex);
}

template <class Message>
class EveryMessage : public ::testing::Test {
 public:
  static Message Golden();
};
template <>
leader_t EveryMessage<leader_t>::Golden() {
  return GoldenLeader();
}
template <>
estimate_t EveryMessage<estimate_t>::Golden() {
  return GoldenEstimate();
}
template <>
telemetry_t EveryMessage<telemetry_t>::Golden() {
  return GoldenTelemetry();
}
using MessageTypes = ::testing::Types<leader_t, estimate_t, telemetry_t>;
TYPED_TEST_SUITE(EveryMessage, MessageTypes);

TYPED_TEST(EveryMessage, DecodesToWhatWasEncoded) {
  MessageBuffer first;
  MessageBuffer second;
  TypeParam decoded;
  const auto bytes = Encode(this->Golden(), &first);
  ASSERT_TRUE(Decode(bytes, &decoded));
  EXPECT_EQ(Hex(Encode(decoded, &second)), Hex(bytes));
}

TYPED_TEST(EveryMessage, IsRefusedAtEveryOtherLength) {
  MessageBuffer buffer{};
  TypeParam decoded;
  const size_t size = Encode(this->Golden(), &buffer).size();
  for (size_t other = 0; other <= buffer.size(); ++other) {
    EXPECT_EQ(Decode(std::span(buffer).first(other), &decoded), other == size) << other;
  }
}

TYPED_TEST(EveryMessage, IsRefusedWithAnyOtherFingerprint) {
  MessageBuffer buffer;
  TypeParam decoded;
  const auto bytes = Encode(this->Golden(), &buffer);
  for (size_t bit = 0; bit < 64; ++bit) {
    const auto flip = static_cast<uint8_t>(1 << (bit % 8));
    buffer[bit / 8] ^= flip;
    EXPECT_FALSE(Decode(bytes, &decoded)) << bit;
    buffer[bit / 8] ^= flip;
  }
  EXPECT_TRUE(Decode(bytes, &decoded));
}

TYPED_TEST(EveryMessage, IsRefusedWithTimesOrDimensionsOutOfRange) {
  const auto accepted = [&](int64_t stamp_ns, int64_t sequence, int task_dim) {
    return IsAcceptedAfter(this->Golden(), [&](TypeParam& m) {
      m.stamp_ns = stamp_ns;
      m.sequence = sequence;
      m.task_dim = static_cast<int8_t>(task_dim);
    });
  };
  EXPECT_TRUE(accepted(0, 1, 2));
  EXPECT_TRUE(accepted(kMaxStampNs, std::numeric_limits<int64_t>::max(), 3));
  EXPECT_FALSE(accepted(-1, 1, 2));
  EXPECT_FALSE(accepted(kMaxStampNs + 1, 1, 2));
  EXPECT_FALSE(accepted(0, 0, 2));
  EXPECT_FALSE(accepted(0, -1, 2));
  EXPECT_FALSE(accepted(0, 1, 1));
  EXPECT_FALSE(accepted(0, 1, 4));
}

TYPED_TEST(EveryMessage, OfRandomBytesIsRefusedOrValid) {
  std::mt19937_64 random(1);
  MessageBuffer buffer;
  const auto bytes = Encode(this->Golden(), &buffer);
  const MessageBuffer golden = buffer;
  int accepted = 0;
  for (int trial = 0; trial < 20'000; ++trial) {
    buffer = golden;
    for (int change = 0; change < 3; ++change)
      buffer[8 + random() % (bytes.size() - 8)] = static_cast<uint8_t>(random());
    TypeParam decoded;
    if (!Decode(bytes, &decoded)) continue;
    ++accepted;
    EXPECT_TRUE(decoded.task_dim == 2 || decoded.task_dim == 3);
    EXPECT_GE(decoded.sequence, 1);
    for (const double x : decoded.x_m) EXPECT_TRUE(std::isfinite(x));
  }
  EXPECT_GT(accepted, 0);
  EXPECT_LT(accepted, 20'000);
}

TEST(Command, IsRefusedWithAnythingOutOfRange) {
  EXPECT_TRUE(IsAccepted(GoldenCommand()));
  const auto refused = [](auto change) { return !IsAcceptedAfter(GoldenCommand(), change); };
  EXPECT_TRUE(refused([](command_t& m) { m.arm_id = -1; }));
  EXPECT_TRUE(refused([](command_t& m) { m.arm_id = kMaxArms + 1; }));
  EXPECT_TRUE(refused([](command_t& m) { m.request = 0; }));
  EXPECT_TRUE(refused([](command_t& m) { m.request = 6; }));
  EXPECT_TRUE(refused([](command_t& m) { m.heard_stamp_ns = -1; }));
  EXPECT_TRUE(refused([](command_t& m) { m.stamp_ns = kMaxStampNs + 1; }));
  EXPECT_TRUE(refused([](command_t& m) { m.sequence = 0; }));
}

TEST(Reply, IsRefusedWithAnythingOutOfRange) {
  EXPECT_TRUE(IsAccepted(GoldenReply()));
  const auto refused = [](auto change) { return !IsAcceptedAfter(GoldenReply(), change); };
  EXPECT_TRUE(refused([](reply_t& m) { m.arm_id = 0; }));
  EXPECT_TRUE(refused([](reply_t& m) { m.request = 6; }));
  EXPECT_TRUE(refused([](reply_t& m) { m.state = 8; }));
  EXPECT_TRUE(refused([](reply_t& m) { m.cause = -1; }));
}

TEST(Leader, IsRefusedWhenAnyNumberIsNotFinite) {
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_FALSE(IsAcceptedAfter(GoldenLeader(), [&](leader_t& m) { m.path_time_s = bad; }));
    for (int i = 0; i < 3; ++i) {
      EXPECT_FALSE(IsAcceptedAfter(GoldenLeader(), [&](leader_t& m) { m.x_m[i] = bad; }));
      EXPECT_FALSE(IsAcceptedAfter(GoldenLeader(), [&](leader_t& m) { m.v_m_s[i] = bad; }));
      EXPECT_FALSE(IsAcceptedAfter(GoldenLeader(), [&](leader_t& m) { m.a_m_s2[i] = bad; }));
      EXPECT_FALSE(IsAcceptedAfter(GoldenLeader(), [&](leader_t& m) { m.jerk_m_s3[i] = bad; }));
    }
  }
}

TEST(Estimate, IsRefusedWhenAnyNumberIsNotFinite) {
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_FALSE(
        IsAcceptedAfter(GoldenEstimate(), [&](estimate_t& m) { m.leader_age_s = static_cast<float>(bad); }));
    for (int i = 0; i < 3; ++i) {
      EXPECT_FALSE(IsAcceptedAfter(GoldenEstimate(), [&](estimate_t& m) { m.x_m[i] = bad; }));
      EXPECT_FALSE(IsAcceptedAfter(GoldenEstimate(), [&](estimate_t& m) { m.v_m_s[i] = bad; }));
      EXPECT_FALSE(IsAcceptedAfter(GoldenEstimate(), [&](estimate_t& m) { m.a_m_s2[i] = bad; }));
      EXPECT_FALSE(IsAcceptedAfter(GoldenEstimate(), [&](estimate_t& m) { m.jerk_m_s3[i] = bad; }));
    }
  }
}

TEST(Estimate, IsRefusedWithAnIdOrAnAgreementOutOfRange) {
  const auto accepted = [](int arm_id, int agreement) {
    return IsAcceptedAfter(GoldenEstimate(), [&](estimate_t& m) {
      m.arm_id = static_cast<int8_t>(arm_id);
      m.agreement = static_cast<int16_t>(agreement);
    });
  };
  EXPECT_TRUE(accepted(1, 0));
  EXPECT_TRUE(accepted(kMaxArms, 32767));
  EXPECT_FALSE(accepted(0, 0));
  EXPECT_FALSE(accepted(-1, 0));
  EXPECT_FALSE(accepted(kMaxArms + 1, 0));
  EXPECT_FALSE(accepted(1, -1));
}

TEST(Telemetry, IsRefusedWithSizesOutOfRange) {
  const auto accepted = [](int arm_id, int dof, int parameter_count, int synced) {
    return IsAcceptedAfter(GoldenTelemetry(), [&](telemetry_t& m) {
      m.arm_id = static_cast<int8_t>(arm_id);
      m.dof = static_cast<int8_t>(dof);
      m.parameter_count = static_cast<int8_t>(parameter_count);
      m.synced = static_cast<int8_t>(synced);
    });
  };
  EXPECT_TRUE(accepted(1, 1, 0, 0));
  EXPECT_FALSE(accepted(0, 1, 0, 0));
  EXPECT_FALSE(accepted(1, 0, 0, 0));
  EXPECT_FALSE(accepted(1, kMaxDof + 1, 0, 0));
  EXPECT_FALSE(accepted(1, 1, -1, 0));
  EXPECT_FALSE(accepted(1, 1, kMaxParameters + 1, 0));
  EXPECT_FALSE(accepted(1, 1, 0, 2));
}

TEST(Telemetry, IsRefusedWhenAnyNumberIsNotFinite) {
  using Change = void (*)(telemetry_t&);
  const std::vector<Change> changes = {[](telemetry_t& m) { m.q_rad[6] = kNaN; },
                                       [](telemetry_t& m) { m.dq_rad_s[6] = kNaN; },
                                       [](telemetry_t& m) { m.tau_Nm[6] = kNaN; },
                                       [](telemetry_t& m) { m.x_m[2] = kNaN; },
                                       [](telemetry_t& m) { m.d_hat_Nm[6] = kNaN; },
                                       [](telemetry_t& m) { m.theta_hat[34] = kNaN; },
                                       [](telemetry_t& m) { m.error_m = kInfinity; },
                                       [](telemetry_t& m) { m.subtask_error_rad_s = kInfinity; },
                                       [](telemetry_t& m) { m.sigma_min = kInfinity; }};
  for (size_t i = 0; i < changes.size(); ++i)
    EXPECT_FALSE(IsAcceptedAfter(GoldenTelemetry(), changes[i])) << i;
}

}  // namespace
}  // namespace armada
