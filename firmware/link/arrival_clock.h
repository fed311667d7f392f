#pragma once

#include <algorithm>
#include <cstdint>

namespace armada {

/// Turns the kernel's arrival stamps, which are wall-clock times, into monotonic ones. Only the difference of
/// the two clocks counts, compared anew at each batch of messages, so that a step of the wall clock does no
/// harm.
class ArrivalClock {
 public:
  /// Call right after a batch was read. The wall clock must be read first: when the thread is preempted in
  /// between, arrivals come out late rather than early, and ClockOffset, which keeps the earliest, ignores
  /// late ones.
  void Update(int64_t wall_now_ns, int64_t monotonic_now_ns) {
    const int64_t difference_ns = wall_now_ns - monotonic_now_ns;
    const int64_t change_ns = difference_ns - difference_ns_;
    stepped_ = change_ns > kStepNs || change_ns < -kStepNs;
    difference_ns_ = difference_ns;
    now_ns_ = monotonic_now_ns;
  }

  /// Monotonic time of a stamp of the present batch; the time of the batch when the wall clock was stepped
  /// since the one before, as the stamp may be of either side of the step.
  int64_t ToMonotonic(int64_t wall_ns) const {
    return stepped_ ? now_ns_ : std::min(wall_ns - difference_ns_, now_ns_);
  }

  /// Monotonic time of the present batch, for a message without a stamp.
  int64_t now_ns() const { return now_ns_; }

 private:
  // Far above what slewing (at most 500 ppm) does in a tick.
  static constexpr int64_t kStepNs = 1'000'000;

  int64_t difference_ns_ = 0;
  int64_t now_ns_ = 0;
  bool stepped_ = false;
};

}  // namespace armada
