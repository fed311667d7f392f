#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

namespace armada {

/// A time in which processors ran nothing of this run; CLOCK_MONOTONIC.
struct Stall {
  int64_t begin_ns = 0;
  int64_t end_ns = 0;
  int processors = 0;  ///< that stood still
  int processor = 0;   ///< the first of them
};

/// Notices that the machine stands still. On each processor that this process may use, a thread of the
/// highest real-time priority wakes every kPeriod_ns and writes down when it wakes late. No program comes
/// before such a thread: what held it up is outside of the machine, as a host that gives the processors to
/// another guest, or has stopped this process. Without the right to that priority it can also have been
/// load; is_foremost() tells.
///
/// The threads neither allocate nor wait for anybody after the constructor.
class Heartbeat {
 public:
  static constexpr int64_t kPeriod_ns = 2'000'000;

  /// Notes wake-ups that are `threshold_ns` late or later.
  explicit Heartbeat(int64_t threshold_ns);
  Heartbeat(const Heartbeat&) = delete;
  Heartbeat& operator=(const Heartbeat&) = delete;
  ~Heartbeat();

  /// Ends the threads: what comes later is of no run.
  void Stop();

  /// Whether every thread has the highest real-time priority.
  bool is_foremost() const { return is_foremost_; }
  /// Processors that are watched.
  int processors() const { return static_cast<int>(pulses_.size()); }
  /// What has been noted so far, in order; what overlaps on several processors is one stall.
  std::vector<Stall> Stalls() const;

 private:
  /// Of one processor. Its thread writes, any other may read what `count` says is there.
  struct Pulse {
    static constexpr size_t kCapacity = 1024;  ///< later ones are not noted
    int processor = 0;
    std::array<Stall, kCapacity> stalls{};
    std::atomic<size_t> count{0};
    std::thread thread;
  };

  void Beat(Pulse* pulse) const;
  void Start(Pulse* pulse);

  int64_t threshold_ns_;
  std::atomic<bool> stop_{false};
  bool is_foremost_ = true;
  std::vector<std::unique_ptr<Pulse>> pulses_;
};

/// Joins what overlaps on several processors.
std::vector<Stall> Joined(std::vector<Stall> stalls);

}  // namespace armada
