#include "firmware/clock/machine_clock.h"

#include <algorithm>

#include "firmware/clock/monotonic.h"

namespace armada {

Clock* MachineClock::Get() {
  static MachineClock clock;
  return &clock;
}

int64_t MachineClock::Now() const {
  return Now_ns(CLOCK_MONOTONIC);
}

int64_t MachineClock::WallNow() const {
  return Now_ns(CLOCK_REALTIME);
}

int64_t MachineClock::ArrivalOf(int /*descriptor*/, const timespec& kernel_stamp) {
  return Nanoseconds(kernel_stamp);
}

void MachineClock::SleepUntil(int64_t deadline_ns) {
  const timespec deadline = Timespec(deadline_ns);
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr);
}

void MachineClock::Wait(std::span<pollfd> inputs, int64_t deadline_ns) {
  const timespec left = Timespec(std::max<int64_t>(0, deadline_ns - Now()));
  ppoll(inputs.data(), inputs.size(), &left, nullptr);
}

}  // namespace armada
