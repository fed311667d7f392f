#pragma once

#include <cstdint>
#include <ctime>

namespace armada {

inline constexpr int64_t kNsPerS = 1'000'000'000;

constexpr int64_t Nanoseconds(const timespec& time) {
  return time.tv_sec * kNsPerS + time.tv_nsec;
}

constexpr timespec Timespec(int64_t time_ns) {
  return {.tv_sec = static_cast<time_t>(time_ns / kNsPerS), .tv_nsec = static_cast<long>(time_ns % kNsPerS)};
}

inline int64_t Now_ns(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return Nanoseconds(now);
}

/// Monotonic time of something that happened at `wall_ns`, carried over by its age. An age that no queue
/// explains means that the wall clock was set in between: then it is now.
constexpr int64_t MonotonicOfWall(int64_t wall_ns, int64_t wall_now_ns, int64_t now_ns) {
  const int64_t age_ns = wall_now_ns - wall_ns;
  return age_ns >= 0 && age_ns < kNsPerS ? now_ns - age_ns : now_ns;
}

}  // namespace armada
