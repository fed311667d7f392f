#include "firmware/app/realtime.h"

#include <malloc.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <cerrno>
#include <cstring>
#include <ctime>

namespace armada {
namespace {

// The stack grows by page faults; touching it once, deeper than the loop ever goes, takes them now.
__attribute__((noinline)) void TouchStack(size_t bytes) {
  auto* memory = static_cast<volatile char*>(__builtin_alloca(bytes));
  for (size_t i = 0; i < bytes; i += 1024) memory[i] = 0;
}

}  // namespace

int64_t MonotonicNow() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

void SleepUntil(int64_t deadline_ns) {
  const timespec deadline{.tv_sec = static_cast<time_t>(deadline_ns / 1'000'000'000),
                          .tv_nsec = static_cast<long>(deadline_ns % 1'000'000'000)};
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr);
}

RealtimeGrant EnterRealtime(int priority, size_t stack_bytes) {
  RealtimeGrant grant;
  mallopt(M_TRIM_THRESHOLD, -1);
  mallopt(M_MMAP_MAX, 0);
  grant.memory_locked = mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  if (!grant.memory_locked) {
    grant.complaint +=
        std::string("memory not locked (") + std::strerror(errno) + "; raise RLIMIT_MEMLOCK). ";
  }
  TouchStack(stack_bytes);
  if (priority > 0) {
    const sched_param parameters{.sched_priority = priority};
    grant.fifo = sched_setscheduler(0, SCHED_FIFO, &parameters) == 0;
    if (!grant.fifo) {
      grant.complaint +=
          std::string("no SCHED_FIFO (") + std::strerror(errno) + "; raise RLIMIT_RTPRIO or run as root). ";
    }
  }
  return grant;
}

void LeaveRealtime() {
  const sched_param none{.sched_priority = 0};
  sched_setscheduler(0, SCHED_OTHER, &none);
}

int64_t PageFaults() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return int64_t{usage.ru_minflt} + usage.ru_majflt;
}

}  // namespace armada
