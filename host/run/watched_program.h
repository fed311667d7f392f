#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>

namespace armada {

/// What a process does, as the kernel has it.
enum class Doing {
  kWork,     ///< at work or waiting for a processor
  kAsleep,   ///< waits for something
  kStopped,  ///< by a signal or a debugger
  kFrozen,   ///< by a control group's freezer, or in the kernel for a disk: it can do nothing about it
  kDead
};
Doing DoingOf(pid_t pid);

/// "arm 3 (pid 4711, stopped by a signal)".
std::string Describe(const std::string& program, pid_t pid);

/// How long a program that somebody waits for could have gone on and did not. Times in which it was stopped
/// or frozen do not count, nor those in which who waits was so itself and did not look.
class Patience {
 public:
  /// `now_ns` of CLOCK_MONOTONIC.
  explicit Patience(int64_t now_ns) : last_look_ns_(now_ns) {}

  /// To be called at least every kLongestLook_ns. Returns the time so far.
  int64_t Look(pid_t pid, int64_t now_ns);

 private:
  static constexpr int64_t kLongestLook_ns = 200'000'000;
  int64_t last_look_ns_;
  int64_t used_ns_ = 0;
};

}  // namespace armada
