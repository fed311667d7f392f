#include "host/run/heartbeat.h"

#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <csignal>

#include "firmware/app/realtime.h"

namespace armada {

Heartbeat::Heartbeat(int64_t threshold_ns) : threshold_ns_(threshold_ns) {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  sched_getaffinity(0, sizeof allowed, &allowed);
  for (int processor = 0; processor < CPU_SETSIZE; ++processor) {
    if (!CPU_ISSET(processor, &allowed)) continue;
    pulses_.push_back(std::make_unique<Pulse>());
    pulses_.back()->processor = processor;
  }
  // Signals are the main thread's: one of them would end a sleep here early.
  sigset_t all;
  sigset_t former;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, &former);
  for (const auto& pulse : pulses_) Start(pulse.get());
  pthread_sigmask(SIG_SETMASK, &former, nullptr);
}

Heartbeat::~Heartbeat() {
  Stop();
}

void Heartbeat::Stop() {
  stop_ = true;
  for (const auto& pulse : pulses_) {
    if (pulse->thread.joinable()) pulse->thread.join();
  }
}

void Heartbeat::Start(Pulse* pulse) {
  pulse->thread = std::thread([this, pulse] { Beat(pulse); });
  const pthread_t handle = pulse->thread.native_handle();
  cpu_set_t own;
  CPU_ZERO(&own);
  CPU_SET(static_cast<size_t>(pulse->processor), &own);
  pthread_setaffinity_np(handle, sizeof own, &own);
  const sched_param highest{.sched_priority = sched_get_priority_max(SCHED_FIFO)};
  if (pthread_setschedparam(handle, SCHED_FIFO, &highest) != 0) is_foremost_ = false;
}

void Heartbeat::Beat(Pulse* pulse) const {
  int64_t due_ns = MonotonicNow() + kPeriod_ns;
  while (!stop_) {
    SleepUntil(due_ns);
    const int64_t now_ns = MonotonicNow();
    const size_t count = pulse->count.load(std::memory_order_relaxed);
    if (now_ns - due_ns >= threshold_ns_ && count < Pulse::kCapacity) {
      pulse->stalls[count] = {due_ns, now_ns, 1, pulse->processor};
      pulse->count.store(count + 1, std::memory_order_release);
    }
    due_ns += ((now_ns - due_ns) / kPeriod_ns + 1) * kPeriod_ns;
  }
}

std::vector<Stall> Heartbeat::Stalls() const {
  std::vector<Stall> stalls;
  for (const auto& pulse : pulses_) {
    const size_t count = pulse->count.load(std::memory_order_acquire);
    stalls.insert(stalls.end(), pulse->stalls.begin(),
                  pulse->stalls.begin() + static_cast<std::ptrdiff_t>(count));
  }
  return Joined(std::move(stalls));
}

// Half of a stall at least is within the one that it joins: two that only touch are two.
std::vector<Stall> Joined(std::vector<Stall> stalls) {
  std::sort(stalls.begin(), stalls.end(),
            [](const Stall& a, const Stall& b) { return a.begin_ns < b.begin_ns; });
  std::vector<Stall> joined;
  std::vector<int> seen;  // processors of the last one
  for (const Stall& stall : stalls) {
    const bool overlaps =
        !joined.empty() && 2 * (joined.back().end_ns - stall.begin_ns) >= stall.end_ns - stall.begin_ns;
    if (!overlaps) {
      joined.push_back(stall);
      seen = {stall.processor};
      continue;
    }
    Stall& last = joined.back();
    last.end_ns = std::max(last.end_ns, stall.end_ns);
    if (std::find(seen.begin(), seen.end(), stall.processor) != seen.end()) continue;
    seen.push_back(stall.processor);
    last.processors = static_cast<int>(seen.size());
  }
  return joined;
}

}  // namespace armada
