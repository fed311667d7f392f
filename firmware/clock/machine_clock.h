#pragma once

#include "firmware/clock/clock.h"

namespace armada {

/// The machine's clock: time passes by itself.
class MachineClock final : public Clock {
 public:
  /// The one that there is: it has no state.
  static Clock* Get();

  int64_t Now() const override;
  int64_t WallNow() const override;
  void SleepUntil(int64_t deadline_ns) override;
  void Wait(std::span<pollfd> inputs, int64_t deadline_ns) override;
  int64_t ArrivalOf(int descriptor, const timespec& kernel_stamp) override;
};

}  // namespace armada
