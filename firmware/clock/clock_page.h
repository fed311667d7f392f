#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace armada {

/// Memory that all programs of a run in stepped time share. One program runs at a time, the holder; it alone
/// writes here, but for what is marked. All that is not atomic to a reader is so by the hand-over of turns.
struct ClockPage {
  static constexpr uint32_t kMagic = 0x41524d32;
  static constexpr size_t kMaxSlots = 72;   // 64 boards, leader, emulation, the run itself, some to spare
  static constexpr size_t kMaxGroups = 72;  // a bus an arm, and LCM
  // Datagrams of a group. A program that is stopped finds those in its socket that came first, however many
  // came since. Memory is taken only for as many as are sent.
  static constexpr size_t kRemembered = size_t{1} << 18;

  enum class State : uint32_t { kAbsent, kWaiting, kRunning, kGone };

  /// A multicast group of the run.
  struct Group {
    std::atomic<uint64_t> address{0};          ///< IPv4 and port; 0: none yet
    std::atomic<uint64_t> sent{0};             ///< datagrams that programs of the run have sent to it
    std::array<int64_t, kRemembered> sent_ns;  ///< when, by their number; untouched before
  };

  /// A program of the run.
  struct Slot {
    std::atomic<uint32_t> turn{0};  ///< futex: 1 when it may run
    std::atomic<State> state{State::kAbsent};
    std::atomic<int32_t> pid{0};
    std::atomic<bool> suspended{false};  ///< gets no turns, as after SIGSTOP
    std::atomic<bool> rung{false};       ///< something was sent to a group that it awaits
    std::atomic<int64_t> deadline_ns{0};
    std::array<std::atomic<uint64_t>, (kMaxGroups + 63) / 64> awaited{};  ///< a bit a group
  };

  uint32_t magic = kMagic;
  uint32_t slots = 0;
  double pace = 0.0;           ///< stepped seconds a real one; 0: as fast as it goes
  int64_t wall_offset_ns = 0;  ///< from stepped time to the run's wall clock
  std::atomic<int64_t> now_ns{0};
  std::atomic<int64_t> next_step_ns{0};  ///< CLOCK_MONOTONIC: when the present instant began, paced
  std::atomic<uint32_t> holder{0};
  std::atomic<uint64_t> turns{0};
  std::atomic<uint64_t> late{0};       ///< datagrams that were not there at once, and then came
  std::atomic<uint64_t> lost{0};       ///< and that never came
  std::atomic<uint64_t> forgotten{0};  ///< and whose time was overwritten before they were read
  std::atomic<uint64_t> dropped{0};  ///< that did not fit into a full socket, of a program that had no turns
  std::atomic<uint64_t> strangers{0};  ///< that no program of the run has sent
  /// CLOCK_MONOTONIC time at which the run let go of its programs, from when on time passes by itself for
  /// them; 0: not yet. Written by the run at any time.
  std::atomic<int64_t> released_ns{0};
  std::array<Group, kMaxGroups> group;
  std::array<Slot, kMaxSlots> slot{};
};
static_assert(std::atomic<uint64_t>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);
static_assert(sizeof(std::atomic<uint32_t>) == 4, "a futex");

}  // namespace armada
