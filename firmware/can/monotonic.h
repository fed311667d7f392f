#pragma once

#include <cstdint>
#include <ctime>

namespace armada {

inline constexpr int64_t kNsPerS = 1'000'000'000;

constexpr int64_t Nanoseconds(const timespec& time) {
  return time.tv_sec * kNsPerS + time.tv_nsec;
}

inline int64_t Now_ns(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return Nanoseconds(now);
}

/// CLOCK_MONOTONIC time of something that the kernel stamped with the wall clock, carried over by its age. An
/// age that no queue explains means that the wall clock was set in between: then it is now.
inline int64_t MonotonicOfWall(const timespec& stamp) {
  const int64_t now_ns = Now_ns(CLOCK_MONOTONIC);
  const int64_t age_ns = Now_ns(CLOCK_REALTIME) - Nanoseconds(stamp);
  return age_ns >= 0 && age_ns < kNsPerS ? now_ns - age_ns : now_ns;
}

}  // namespace armada
