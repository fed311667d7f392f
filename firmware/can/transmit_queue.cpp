#include "firmware/can/transmit_queue.h"

#include <algorithm>

namespace armada {

TransmitQueue::Taken TransmitQueue::Push(const CanFrame& frame) {
  if (frame.latest_only) {
    for (size_t i = waiting_count_; i-- > 0;) {
      CanFrame& waiting = waiting_[i];
      if (waiting.id != frame.id || waiting.extended != frame.extended) continue;
      if (!waiting.latest_only) break;  // it must go first: it switches the drive
      waiting = frame;
      return Taken::kReplaced;
    }
  }
  if (waiting_count_ == kCapacity) return Taken::kFull;
  waiting_[waiting_count_++] = frame;
  return Taken::kQueued;
}

const CanFrame* TransmitQueue::Next() const {
  return waiting_count_ > 0 && in_flight_count_ < window_ ? &waiting_[0] : nullptr;
}

void TransmitQueue::HandedOver() {
  in_flight_[in_flight_count_++] = waiting_[0].id;
  RemoveFirst();
}

void TransmitQueue::Refused() {
  RemoveFirst();
}

bool TransmitQueue::Confirm(const CanFrame& echo) {
  const auto end = in_flight_.begin() + static_cast<std::ptrdiff_t>(in_flight_count_);
  const auto found = std::find(in_flight_.begin(), end, echo.id);
  if (found == end) return false;
  std::move(found + 1, end, found);
  --in_flight_count_;
  return true;
}

size_t TransmitQueue::DropWaiting() {
  const size_t dropped = waiting_count_;
  waiting_count_ = 0;
  return dropped;
}

void TransmitQueue::RemoveFirst() {
  std::move(waiting_.begin() + 1, waiting_.begin() + static_cast<std::ptrdiff_t>(waiting_count_),
            waiting_.begin());
  --waiting_count_;
}

}  // namespace armada
