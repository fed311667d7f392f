#include "firmware/clock/stepped_clock.h"

#include <linux/futex.h>
#include <linux/sock_diag.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "firmware/clock/monotonic.h"

namespace armada {
namespace {

constexpr int64_t kLook_ns = 50'000'000;
// Loopback delivers before send() returns. Where the machine steers packets to other processors (RPS) they
// come later; a second is a thousand times as long as was ever seen.
constexpr int kOwed_ms = 1000;
// Behind by more than this, the pace begins anew: a stall is not made up for by racing.
constexpr int64_t kBehind_ns = 100'000'000;

uint64_t KeyOf(const sockaddr_in& group) {
  return uint64_t{group.sin_addr.s_addr} << 16 | group.sin_port;
}

// Datagrams that the kernel has thrown away at this socket, so far.
uint64_t DroppedAt(int descriptor) {
  std::array<uint32_t, SK_MEMINFO_VARS> info{};
  socklen_t size = sizeof info;
  if (getsockopt(descriptor, SOL_SOCKET, SO_MEMINFO, info.data(), &size) != 0) return 0;
  return info[SK_MEMINFO_DROPS];
}

bool IsReadable(int descriptor, int timeout_ms) {
  pollfd input{descriptor, POLLIN, 0};
  int ready = 0;
  do {
    ready = poll(&input, 1, timeout_ms);
  } while (ready < 0 && errno == EINTR);
  return ready > 0;
}

}  // namespace

ClockPage* SteppedClock::Map(int descriptor, std::string* error) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0 || status.st_size != static_cast<off_t>(sizeof(ClockPage))) {
    *error = "stepped clock: descriptor " + std::to_string(descriptor) + " is no clock page of this version";
    return nullptr;
  }
  void* const memory = mmap(nullptr, sizeof(ClockPage), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
  if (memory != MAP_FAILED) return static_cast<ClockPage*>(memory);
  *error = std::string("stepped clock: ") + std::strerror(errno);
  return nullptr;
}

std::unique_ptr<SteppedClock> SteppedClock::Attach(int descriptor, int slot, std::string* error) {
  ClockPage* const page = Map(descriptor, error);
  if (page == nullptr) return nullptr;
  if (page->magic != ClockPage::kMagic || slot < 1 || static_cast<uint32_t>(slot) >= page->slots) {
    *error = "stepped clock: has no slot " + std::to_string(slot) + " for a program";
    munmap(page, sizeof(ClockPage));
    return nullptr;
  }
  std::unique_ptr<SteppedClock> clock(new SteppedClock(page, static_cast<size_t>(slot)));
  ClockPage::Slot& self = clock->self();
  self.pid = getpid();
  self.deadline_ns = page->now_ns.load();
  self.state = State::kWaiting;
  clock->AwaitTurn();
  return clock;
}

SteppedClock::~SteppedClock() {
  self().state = State::kGone;
  if (!released()) PassOn();
  munmap(page_, sizeof(ClockPage));
}

int64_t SteppedClock::Now() const {
  const int64_t released_ns = page_->released_ns.load();
  return page_->now_ns.load() + (released_ns == 0 ? 0 : Now_ns(CLOCK_MONOTONIC) - released_ns);
}

void SteppedClock::Wait(std::span<pollfd> inputs, int64_t deadline_ns) {
  if (released()) {
    const timespec left = Timespec(std::max<int64_t>(0, deadline_ns - Now()));
    ppoll(inputs.data(), inputs.size(), &left, nullptr);
    return;
  }
  const auto has_input = [&] { return poll(inputs.data(), inputs.size(), 0) > 0; };
  if ((!inputs.empty() && has_input()) || deadline_ns <= Now()) return;
  ClockPage::Slot& slot = self();
  Await(inputs);
  do {
    slot.deadline_ns = deadline_ns;
    slot.rung = false;
    slot.state = State::kWaiting;
    PassOn();
    if (!AwaitTurn()) break;
    if (slot.rung) AwaitOwed(inputs);
  } while (!(!inputs.empty() && has_input()) && page_->now_ns < deadline_ns);
  Await({});
}

void SteppedClock::Await(std::span<const pollfd> inputs) {
  std::array<uint64_t, (ClockPage::kMaxGroups + 63) / 64> awaited{};
  for (const pollfd& input : inputs) {
    if (const Subscription* found = Find(input.fd))
      awaited[found->group / 64] |= uint64_t{1} << found->group % 64;
  }
  for (size_t i = 0; i < awaited.size(); ++i) self().awaited[i] = awaited[i];
}

void SteppedClock::PassOn() {
  size_t next = ChooseInThisInstant();
  while (next == kNobody) {
    const int64_t least_ns = LeastDeadline();
    if (least_ns == INT64_MAX) return;  // nobody is left
    StepTo(least_ns);
    next = ChooseInThisInstant();
  }
  page_->holder = static_cast<uint32_t>(next);
  ++page_->turns;
  page_->slot[next].turn = 1;
  if (next != slot_) Wake(&page_->slot[next].turn);
}

size_t SteppedClock::ChooseInThisInstant() const {
  const int64_t now_ns = page_->now_ns;
  size_t rung = kNobody;
  for (size_t i = 0; i < page_->slots; ++i) {
    const ClockPage::Slot& slot = page_->slot[i];
    if (slot.state != State::kWaiting || slot.suspended) continue;
    if (slot.deadline_ns <= now_ns) return i;
    if (slot.rung && (rung == kNobody || rung == 0)) rung = i;
  }
  return rung;
}

int64_t SteppedClock::LeastDeadline() const {
  int64_t least_ns = INT64_MAX;
  for (size_t i = 0; i < page_->slots; ++i) {
    const ClockPage::Slot& slot = page_->slot[i];
    if (slot.state == State::kWaiting && !slot.suspended)
      least_ns = std::min(least_ns, slot.deadline_ns.load());
  }
  return least_ns;
}

void SteppedClock::StepTo(int64_t time_ns) {
  if (page_->pace > 0.0) KeepPace(time_ns - page_->now_ns);
  page_->now_ns = time_ns;
}

void SteppedClock::KeepPace(int64_t step_ns) {
  const int64_t real_ns = Now_ns(CLOCK_MONOTONIC);
  int64_t next_ns = page_->next_step_ns + static_cast<int64_t>(static_cast<double>(step_ns) / page_->pace);
  if (real_ns > next_ns + kBehind_ns) next_ns = real_ns;
  page_->next_step_ns = next_ns;
  const timespec until = Timespec(next_ns);
  while (!released() && clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

bool SteppedClock::AwaitTurn() {
  ClockPage::Slot& slot = self();
  bool wait_on = true;
  while (slot.turn == 0 && wait_on) {
    WaitOn(&slot.turn, 0, kLook_ns);
    wait_on = slot.turn != 0 || (!released() && MayWaitOn());
  }
  slot.turn = 0;
  slot.state = State::kRunning;
  return wait_on && !released();
}

bool SteppedClock::MayWaitOn() {
  if (getppid() == parent_) return true;
  raise(SIGTERM);
  return false;
}

void SteppedClock::Wake(std::atomic<uint32_t>* word) {
  syscall(SYS_futex, word, FUTEX_WAKE, 1, nullptr, nullptr, 0);
}

void SteppedClock::WaitOn(std::atomic<uint32_t>* word, uint32_t value, int64_t longest_ns) {
  const timespec longest = Timespec(longest_ns);
  syscall(SYS_futex, word, FUTEX_WAIT, value, &longest, nullptr, 0);
}

size_t SteppedClock::GroupOf(const sockaddr_in& group) {
  const uint64_t key = KeyOf(group);
  for (size_t i = 0; i < page_->group.size(); ++i) {
    if (page_->group[i].address == 0) page_->group[i].address = key;
    if (page_->group[i].address == key) return i;
  }
  return page_->group.size() - 1;  // more than a fleet has: these share one, and are woken too often
}

SteppedClock::Subscription* SteppedClock::Find(int descriptor) {
  const auto end = subscriptions_.begin() + static_cast<std::ptrdiff_t>(subscription_count_);
  const auto found = std::find_if(subscriptions_.begin(), end,
                                  [&](const Subscription& one) { return one.descriptor == descriptor; });
  return found == end ? nullptr : &*found;
}

void SteppedClock::Joined(int descriptor, const sockaddr_in& group) {
  if (subscription_count_ == subscriptions_.size()) return;
  const size_t number = GroupOf(group);
  subscriptions_[subscription_count_++] = {descriptor, number, page_->group[number].sent};
}

void SteppedClock::Sent(const sockaddr_in& group) {
  if (released()) return;
  const size_t number = GroupOf(group);
  ClockPage::Group& to = page_->group[number];
  to.sent_ns[to.sent % ClockPage::kRemembered] = page_->now_ns.load();
  ++to.sent;
  for (size_t i = 0; i < page_->slots; ++i) {
    ClockPage::Slot& slot = page_->slot[i];
    if ((slot.awaited[number / 64] >> number % 64 & 1) != 0) slot.rung = true;
  }
}

// Every socket gets a group's datagrams in the order in which they were sent, so that their number tells
// when.
int64_t SteppedClock::ArrivalOf(int descriptor, const timespec& /*kernel_stamp*/) {
  Subscription* const subscription = Find(descriptor);
  if (subscription == nullptr || released()) return WallNow();
  const ClockPage::Group& group = page_->group[subscription->group];
  const uint64_t number = subscription->due++;
  if (number >= group.sent) return WallNow();  // a stranger's
  if (group.sent - number > ClockPage::kRemembered) ++page_->forgotten;
  return group.sent_ns[number % ClockPage::kRemembered] + page_->wall_offset_ns;
}

bool SteppedClock::MoreToCome(int descriptor) {
  Subscription* const subscription = Find(descriptor);
  return subscription != nullptr && !released() && AwaitOwed(subscription);
}

uint64_t SteppedClock::Owed(const Subscription& subscription) const {
  const uint64_t sent = page_->group[subscription.group].sent;
  return sent > subscription.due ? sent - subscription.due : 0;
}

// The socket is empty, so that the count of datagrams can be set right: what is missing is late, was dropped
// where it did not fit, or is lost; what is too much came from strangers.
bool SteppedClock::AwaitOwed(Subscription* subscription) {
  const uint64_t sent = page_->group[subscription->group].sent;
  if (subscription->due > sent) page_->strangers += subscription->due - sent;
  if (subscription->due > sent) subscription->due = sent;
  if (Owed(*subscription) == 0) return false;
  if (IsReadable(subscription->descriptor, 0)) return true;
  const uint64_t dropped = DroppedAt(subscription->descriptor);
  if (Owed(*subscription) > dropped - subscription->dropped) {
    if (IsReadable(subscription->descriptor, kOwed_ms)) {
      ++page_->late;
      return true;
    }
    page_->lost += Owed(*subscription);
  } else {
    page_->dropped += Owed(*subscription);
  }
  subscription->dropped = dropped;
  subscription->due = sent;
  return false;
}

void SteppedClock::AwaitOwed(std::span<const pollfd> inputs) {
  for (const pollfd& input : inputs) {
    Subscription* const subscription = Find(input.fd);
    if (subscription != nullptr && !IsReadable(input.fd, 0)) AwaitOwed(subscription);
  }
}

}  // namespace armada
