#pragma once

#include <unistd.h>

#include <array>
#include <memory>
#include <string>

#include "firmware/clock/clock.h"
#include "firmware/clock/clock_page.h"

namespace armada {

/// The clock of a run in stepped time, as one of its programs sees it (conservative discrete-event
/// execution). One program runs at a time. Who begins to wait hands the turn on: to the next whose deadline
/// has come, in the order of the slots; when there is none, to one that awaits a datagram which has come,
/// slot 0 last; when there is none either, time becomes the least deadline. Computing takes no time, what is
/// sent arrives in the same instant, and whoever is slow is waited for.
///
/// Emulation only: a program that uses it must have no real bus and no real network.
class SteppedClock : public Clock {
 public:
  /// Joins the run whose page is the file open as `descriptor`, as program `slot`, and returns when it is its
  /// turn. Null, and the reason in `error`, on failure.
  static std::unique_ptr<SteppedClock> Attach(int descriptor, int slot, std::string* error);

  /// Leaves the run.
  ~SteppedClock() override;

  bool IsStepped() const override { return true; }
  int64_t Now() const override;
  int64_t WallNow() const override { return Now() + page_->wall_offset_ns; }
  void SleepUntil(int64_t deadline_ns) override { Wait({}, deadline_ns); }
  void Wait(std::span<pollfd> inputs, int64_t deadline_ns) override;
  void Joined(int descriptor, const sockaddr_in& group) override;
  void Sent(const sockaddr_in& group) override;
  int64_t ArrivalOf(int descriptor, const timespec& kernel_stamp) override;
  bool MoreToCome(int descriptor) override;

 protected:
  using State = ClockPage::State;

  /// `slot` runs from now on.
  SteppedClock(ClockPage* page, size_t slot) : page_(page), slot_(slot), parent_(getppid()) {}

  /// Maps a page; null, and the reason in `error`, on failure.
  static ClockPage* Map(int descriptor, std::string* error);

  /// Asked every 50 ms of the machine's time while it waits for its turn; false: waits no longer. A program
  /// whose run has died is to end: it gets SIGTERM.
  virtual bool MayWaitOn();

  /// No program waits for another any more.
  bool released() const { return page_->released_ns.load() != 0; }
  ClockPage* page() const { return page_; }
  ClockPage::Slot& self() { return page_->slot[slot_]; }

  /// Hands the turn on, in the midst of an instant or with a step of time.
  void PassOn();

  static void Wake(std::atomic<uint32_t>* word);
  /// Waits while `word` is `value`, at most that long.
  static void WaitOn(std::atomic<uint32_t>* word, uint32_t value, int64_t longest_ns);

 private:
  /// A socket of this process.
  struct Subscription {
    int descriptor = -1;
    size_t group = 0;
    uint64_t due = 0;      ///< of the datagrams sent to the group: how many were read, or before its time
    uint64_t dropped = 0;  ///< at this socket, known of so far
  };

  static constexpr size_t kNobody = ClockPage::kMaxSlots;
  size_t ChooseInThisInstant() const;
  int64_t LeastDeadline() const;
  void StepTo(int64_t time_ns);
  uint64_t Owed(const Subscription& subscription) const;
  void KeepPace(int64_t step_ns);
  /// False when it is no use to wait any longer.
  bool AwaitTurn();
  size_t GroupOf(const sockaddr_in& group);
  Subscription* Find(int descriptor);
  void Await(std::span<const pollfd> inputs);
  /// A datagram that was sent is not there yet: waits for it, as far as there is hope. True: it has come.
  bool AwaitOwed(Subscription* subscription);
  void AwaitOwed(std::span<const pollfd> inputs);

  ClockPage* page_;
  size_t slot_;
  pid_t parent_;
  std::array<Subscription, ClockPage::kMaxGroups> subscriptions_{};
  size_t subscription_count_ = 0;
};

}  // namespace armada
