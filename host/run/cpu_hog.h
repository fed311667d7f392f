#pragma once

#include <cstdint>
#include <thread>

namespace armada {

/// A thread that keeps a processor busy from one time of CLOCK_MONOTONIC to another, as a program gone wild
/// would. Ends with the object at the latest.
class CpuHog {
 public:
  /// `priority`: of SCHED_FIFO; 0: none, or as far as it is not granted.
  CpuHog(int priority, int64_t from_ns, int64_t until_ns);

 private:
  std::jthread thread_;
};

}  // namespace armada
