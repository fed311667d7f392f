#include "firmware/app/operator_desk.h"

#include <gtest/gtest.h>

#include "firmware/link/channels.h"

namespace armada {
namespace {

constexpr int64_t kNowNs = 100'000'000'000;
constexpr int64_t kTickNs = 10'000'000;
constexpr int64_t kDigest = 42;
const FleetKey kKey{1, 2, 3};

class Desk : public testing::Test {
 protected:
  static command_t Command(Request request, int64_t heard_ns = kNowNs - kTickNs) {
    command_t command{};
    command.stamp_ns = 5;
    command.sequence = 1;
    command.arm_id = 3;
    command.request = static_cast<int8_t>(request);
    command.heard_stamp_ns = heard_ns;
    command.fleet_digest = kDigest;
    return command;
  }
  void Hear(const command_t& command, OperatorDesk* desk = nullptr) {
    (desk != nullptr ? desk : &desk_)->OnMessage({kCommandChannel, Encode(command, &buffer_), kNowNs});
  }
  Refusals RefusalsOf(const command_t& command) {
    Hear(command);
    desk_.TakeRequest(kNowNs);
    desk_.Answer(0, ControllerState::kMonitor, Cause::kNone);
    const auto reply = desk_.TakeReply(kNowNs);
    return reply ? static_cast<Refusals>(reply->refusals) : 0xFFFF'FFFF;
  }

  MessageBuffer buffer_{};
  OperatorDesk desk_{3, std::nullopt, kDigest, 1.0};
};

TEST_F(Desk, TakesACommandOnceAndAnswersIt) {
  Hear(Command(Request::kArm));
  EXPECT_EQ(desk_.TakeRequest(kNowNs), Request::kArm);
  desk_.Answer(Bit(Refusal::kMoving), ControllerState::kMonitor, Cause::kNone);
  const auto reply = desk_.TakeReply(kNowNs);
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->command_stamp_ns, 5);
  EXPECT_EQ(static_cast<Refusals>(reply->refusals), Bit(Refusal::kMoving));
  EXPECT_FALSE(desk_.TakeReply(kNowNs));
  EXPECT_EQ(desk_.TakeRequest(kNowNs + kTickNs), Request::kNone);

  Hear(Command(Request::kArm));  // sent again: the answer was lost
  EXPECT_EQ(desk_.TakeRequest(kNowNs + kTickNs), Request::kNone);
  EXPECT_TRUE(desk_.TakeReply(kNowNs));
}

TEST_F(Desk, IgnoresCommandsForOthers) {
  command_t command = Command(Request::kStart);
  command.arm_id = 4;
  Hear(command);
  command.arm_id = 0;
  Hear(command);
  EXPECT_EQ(desk_.TakeRequest(kNowNs), Request::kNone) << "all at once is for e-stops only";
  EXPECT_EQ(desk_.rejected(), 0);
}

TEST_F(Desk, RefusesWhatWasRecordedEarlierAndAnotherFleetFile) {
  EXPECT_EQ(RefusalsOf(Command(Request::kStart, kNowNs - 1'000'000'000)), Bit(Refusal::kStale));
  EXPECT_EQ(RefusalsOf(Command(Request::kStart, kNowNs + 1'000'000'000)), Bit(Refusal::kStale));
  EXPECT_EQ(RefusalsOf(Command(Request::kStart, 0)), Bit(Refusal::kStale)) << "of an earlier start";
  command_t other = Command(Request::kArm);
  other.fleet_digest = kDigest + 1;
  EXPECT_EQ(RefusalsOf(other), Bit(Refusal::kFleetDiffers));
}

TEST_F(Desk, ARecordedCommandIsWorthNothingAMomentLater) {
  command_t start = Command(Request::kStart, kNowNs - 3 * kTickNs);
  EXPECT_EQ(RefusalsOf(start), 0u);
  command_t hold = Command(Request::kHold, kNowNs - 2 * kTickNs);
  hold.stamp_ns = 6;
  EXPECT_EQ(RefusalsOf(hold), 0u);
  Hear(start);  // somebody plays the start again
  EXPECT_EQ(desk_.TakeRequest(kNowNs), Request::kNone);
}

TEST_F(Desk, ARecordedCommandDoesNotDisplaceOneThatIsNewer) {
  Hear(Command(Request::kStart, kNowNs - 3 * kTickNs));
  command_t hold = Command(Request::kHold, kNowNs - 2 * kTickNs);
  hold.stamp_ns = 6;
  Hear(hold);
  Hear(Command(Request::kStart, kNowNs - 3 * kTickNs));  // somebody plays it again before the tick
  EXPECT_EQ(desk_.TakeRequest(kNowNs), Request::kHold);
}

TEST_F(Desk, AnEstopCountsAlwaysAndIsNotOvertaken) {
  for (const int8_t arm : {int8_t{0}, int8_t{3}}) {
    command_t estop = Command(Request::kEstop, 0);
    estop.arm_id = arm;
    estop.fleet_digest = 7;
    Hear(estop);
    Hear(Command(Request::kStart));
    EXPECT_EQ(desk_.TakeRequest(kNowNs), Request::kEstop);
    desk_.Answer(0, ControllerState::kSafeStop, Cause::kEstop);
    Hear(estop);
    EXPECT_EQ(desk_.TakeRequest(kNowNs), Request::kEstop) << "again";
    desk_.Answer(0, ControllerState::kFault, Cause::kEstop);
  }
}

TEST_F(Desk, WithAKeyBelievesTheOperatorOnly) {
  OperatorDesk desk(3, LinkIdentity{kKey, 1}, kDigest, 1.0);
  const command_t command = Command(Request::kEstop);
  Hear(command, &desk);
  EXPECT_EQ(desk.rejected(), 1);
  for (const int sender : {kLeaderSender, 3, 5}) {
    Sealer stranger({kKey, 1}, sender);
    desk.OnMessage(
        {kCommandChannel, stranger.Seal(kCommandChannel, Encode(command, &buffer_), &buffer_), kNowNs});
  }
  EXPECT_EQ(desk.rejected(), 4);
  EXPECT_EQ(desk.TakeRequest(kNowNs), Request::kNone);
  Sealer genuine({kKey, 9}, kOperatorSender);
  desk.OnMessage(
      {kCommandChannel, genuine.Seal(kCommandChannel, Encode(command, &buffer_), &buffer_), kNowNs});
  EXPECT_EQ(desk.TakeRequest(kNowNs), Request::kEstop);
}

TEST_F(Desk, CountsWhatIsNoCommand) {
  const std::array<uint8_t, 4> junk{1, 2, 3, 4};
  desk_.OnMessage({kCommandChannel, junk, kNowNs});
  EXPECT_EQ(desk_.rejected(), 1);
  desk_.OnMessage({"EST_1", junk, kNowNs});
  EXPECT_EQ(desk_.rejected(), 1);
}

}  // namespace
}  // namespace armada
