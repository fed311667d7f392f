#include "host/run/cpu_hog.h"

#include <sched.h>

#include <chrono>
#include <condition_variable>
#include <csignal>
#include <mutex>

#include "firmware/app/realtime.h"

namespace armada {
namespace {

void KeepBusy(const std::stop_token& stop, int priority, int64_t from_ns, int64_t until_ns) {
  if (priority > 0) {
    const sched_param parameters{.sched_priority = priority};
    sched_setscheduler(0, SCHED_FIFO, &parameters);
  }
  std::mutex mutex;
  std::condition_variable_any never;
  std::unique_lock lock(mutex);
  const std::chrono::steady_clock::time_point from{std::chrono::nanoseconds(from_ns)};  // CLOCK_MONOTONIC
  never.wait_until(lock, stop, from, [] { return false; });
  while (!stop.stop_requested() && MonotonicNow() < until_ns) {
  }
}

}  // namespace

// Signals are the main thread's.
CpuHog::CpuHog(int priority, int64_t from_ns, int64_t until_ns) {
  sigset_t all;
  sigset_t former;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, &former);
  thread_ = std::jthread(KeepBusy, priority, from_ns, until_ns);
  pthread_sigmask(SIG_SETMASK, &former, nullptr);
}

}  // namespace armada
