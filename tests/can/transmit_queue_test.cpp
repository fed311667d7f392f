#include "firmware/can/transmit_queue.h"

#include <gtest/gtest.h>

#include "tests/can/frames.h"

namespace armada {
namespace {

using Taken = TransmitQueue::Taken;

CanFrame Torque(uint32_t id, uint8_t value) {
  CanFrame frame = DataFrame(id, {value});
  frame.latest_only = true;
  return frame;
}

/// Hands over what the window lets pass; returns the first byte of each frame.
std::vector<int> HandOver(TransmitQueue* queue) {
  std::vector<int> values;
  while (const CanFrame* frame = queue->Next()) {
    values.push_back(frame->data[0]);
    queue->HandedOver();
  }
  return values;
}

TEST(TransmitQueue, KeepsOrderAndNoMoreThanItsWindowWithTheKernel) {
  TransmitQueue queue(2);
  for (uint8_t i = 1; i <= 4; ++i) EXPECT_EQ(queue.Push(DataFrame(i, {i})), Taken::kQueued);
  EXPECT_EQ(HandOver(&queue), (std::vector{1, 2}));
  EXPECT_EQ(queue.waiting(), 2u);
  EXPECT_TRUE(queue.Confirm(DataFrame(1, {1})));
  EXPECT_EQ(HandOver(&queue), (std::vector{3}));
  EXPECT_TRUE(queue.Confirm(DataFrame(2, {2})));
  EXPECT_TRUE(queue.Confirm(DataFrame(3, {3})));
  EXPECT_EQ(HandOver(&queue), (std::vector{4}));
}

TEST(TransmitQueue, ANewTorqueTakesThePlaceOfAnOldOneThatWaits) {
  TransmitQueue queue(1);
  queue.Push(DataFrame(0x10, {0}));
  HandOver(&queue);  // the window is full
  EXPECT_EQ(queue.Push(Torque(0x11, 1)), Taken::kQueued);
  EXPECT_EQ(queue.Push(Torque(0x12, 2)), Taken::kQueued);
  EXPECT_EQ(queue.Push(Torque(0x11, 3)), Taken::kReplaced);
  queue.Confirm(DataFrame(0x10, {0}));
  EXPECT_EQ(HandOver(&queue), (std::vector{3}));
  queue.Confirm(Torque(0x11, 3));
  EXPECT_EQ(HandOver(&queue), (std::vector{2}));
}

TEST(TransmitQueue, ATorqueDoesNotOvertakeWhatSwitchesItsDrive) {
  TransmitQueue queue(1);
  queue.Push(DataFrame(0x10, {0}));
  HandOver(&queue);
  queue.Push(Torque(0x11, 1));
  queue.Push(DataFrame(0x11, {2}));  // MIT: enable and torque have one identifier
  EXPECT_EQ(queue.Push(Torque(0x11, 3)), Taken::kQueued);
  EXPECT_EQ(queue.Push(Torque(0x11, 4)), Taken::kReplaced);
  EXPECT_EQ(queue.waiting(), 3u);
}

TEST(TransmitQueue, IsBounded) {
  TransmitQueue queue(1);
  for (size_t i = 0; i < TransmitQueue::kCapacity; ++i) {
    ASSERT_EQ(queue.Push(DataFrame(static_cast<uint32_t>(i), {})), Taken::kQueued);
  }
  EXPECT_EQ(queue.Push(DataFrame(0x7FF, {})), Taken::kFull);
  EXPECT_EQ(queue.DropWaiting(), TransmitQueue::kCapacity);
  EXPECT_EQ(queue.Next(), nullptr);
}

TEST(TransmitQueue, TheEchoOfAFrameThatIsNotInFlightConfirmsNothing) {
  TransmitQueue queue(1);
  queue.Push(DataFrame(1, {1}));
  EXPECT_FALSE(queue.Confirm(DataFrame(1, {1}))) << "not handed over yet";
  HandOver(&queue);
  EXPECT_FALSE(queue.Confirm(DataFrame(2, {1})));
  queue.ForgetInFlight();
  EXPECT_FALSE(queue.Confirm(DataFrame(1, {1}))) << "lost in a bus-off";
  EXPECT_EQ(queue.in_flight(), 0u);
}

}  // namespace
}  // namespace armada
