#pragma once

#include <cstdint>
#include <string>

namespace armada {

/// CLOCK_MONOTONIC, ns: the only clock of the control path.
int64_t MonotonicNow();

/// Sleeps until the clock shows `deadline_ns`; returns early when a signal comes.
void SleepUntil(int64_t deadline_ns);

/// What the operating system granted this process.
struct RealtimeGrant {
  bool memory_locked = false;
  bool fifo = false;
  std::string complaint;  ///< what was refused and what to do; empty when all was granted
};

/// Locks all present and future memory, touches `stack_bytes` of stack so that it is mapped, keeps the heap
/// from giving memory back, and asks for SCHED_FIFO at `priority` (0: does not ask). Start-up only.
RealtimeGrant EnterRealtime(int priority, size_t stack_bytes = size_t{512} * 1024);

/// Back to the ordinary scheduler: what a program does after its loop must not hold up the loops of others.
void LeaveRealtime();

/// Page faults of this process so far, minor and major.
int64_t PageFaults();

}  // namespace armada
