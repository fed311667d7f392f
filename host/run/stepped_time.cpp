#include "host/run/stepped_time.h"

#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <iostream>
#include <new>

#include "firmware/clock/monotonic.h"
#include "host/run/watched_program.h"

namespace armada {
namespace {

using std::chrono::milliseconds;

constexpr int64_t kStart_ns = 1000 * kNsPerS;                 // as of a machine that is up for a while
constexpr int64_t kWallAtStart_ns = 1'767'225'600 * kNsPerS;  // 2026-01-01 00:00:00 UTC: the same in each run
constexpr int64_t kTold_ns = 900'000'000;                     // of one turn, on the machine's clock
constexpr int64_t kHung_cpu_ns = 900'000'000;                 // of one turn, on its own processor time
constexpr int64_t kHung_ns = 30 * kNsPerS;                    // asleep in its turn, or not ending
constexpr int64_t kPatience_ns = 60 * kNsPerS;                // for a program to come up

int64_t ProcessorTime(pid_t pid) {
  clockid_t clock{};
  return clock_getcpuclockid(pid, &clock) == 0 ? Now_ns(clock) : 0;
}

std::string Seconds(int64_t duration_ns) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f s", 1e-9 * static_cast<double>(duration_ns));
  return text;
}

}  // namespace

std::unique_ptr<SteppedTime> SteppedTime::Create(double pace, std::string* error) {
  UniqueFd file(memfd_create("armada-clock", MFD_CLOEXEC));
  if (!file.valid() || ftruncate(file.get(), sizeof(ClockPage)) != 0) {
    *error = std::string("stepped time: no memory for its page: ") + std::strerror(errno);
    return nullptr;
  }
  ClockPage* const memory = Map(file.get(), error);
  if (memory == nullptr) return nullptr;
  auto* const page = new (memory) ClockPage;
  page->slots = 1;
  page->pace = pace;
  page->wall_offset_ns = kWallAtStart_ns - kStart_ns;
  page->now_ns = kStart_ns;
  page->slot[0].state = State::kRunning;
  page->slot[0].pid = getpid();
  return std::unique_ptr<SteppedTime>(new SteppedTime(page, std::move(file)));
}

SteppedTime::~SteppedTime() {
  Release();
}

ClockPage::Slot* SteppedTime::Find(const std::string& program) {
  const auto found = std::find(programs_.begin(), programs_.end(), program);
  if (found == programs_.end()) return nullptr;
  return &page()->slot[static_cast<size_t>(found - programs_.begin()) + 1];
}

std::vector<std::string> SteppedTime::ArgumentsFor(const std::string& program) {
  ClockPage::Slot* slot = Find(program);
  if (slot == nullptr) {
    programs_.push_back(program);
    running_.push_back(false);
    page()->slots = static_cast<uint32_t>(programs_.size() + 1);
    slot = Find(program);
  }
  slot->state = State::kAbsent;
  slot->suspended = false;
  slot->rung = false;
  const auto number = slot - page()->slot.data();
  running_[static_cast<size_t>(number - 1)] = true;
  return {"--stepped-clock", std::to_string(file_.get()) + ":" + std::to_string(number)};
}

bool SteppedTime::AwaitPrograms(ProcessGroup* group, std::string* error) {
  const int64_t begin_ns = Now_ns(CLOCK_MONOTONIC);
  bool told = false;
  for (size_t i = 0; i < programs_.size(); ++i) {
    Patience patience(Now_ns(CLOCK_MONOTONIC));
    while (running_[i] && page()->slot[i + 1].state == State::kAbsent) {
      const auto ended = group->Poll(milliseconds(1));
      if (ended && !NoteEnd(*ended)) {
        *error = ended->Describe();
        return false;
      }
      if (ProcessGroup::StopRequested()) {
        *error = "interrupted; everything is stopped";
        return false;
      }
      const int64_t now_ns = Now_ns(CLOCK_MONOTONIC);
      const pid_t pid = group->Find(programs_[i]).value_or(0);
      const int64_t waited_ns = patience.Look(pid, now_ns);
      if (now_ns - begin_ns < kTold_ns || ended) continue;
      const std::string who = Describe(programs_[i], pid);
      if (waited_ns > kPatience_ns) {
        *error = "has not come up within " + Seconds(kPatience_ns) + ": " + who;
        return false;
      }
      if (!told) std::cerr << "armada run: waiting for " << who << " to come up" << std::endl;
      told = true;
    }
  }
  if (began_ns_ == 0) began_ns_ = Now_ns(CLOCK_MONOTONIC);
  page()->next_step_ns = Now_ns(CLOCK_MONOTONIC);
  return true;
}

std::string SteppedTime::WhoseEndIsAwaited() const {
  for (size_t i = 0; i < running_.size(); ++i) {
    if (running_[i] && page()->slot[i + 1].state == State::kGone) return programs_[i];
  }
  return "";
}

// Ends are taken note of before time goes on: when a program has left is then the same in each run, and time
// does not run away while the last ones end.
std::optional<ProcessExit> SteppedTime::Pass(ProcessGroup* group, std::span<pollfd> inputs,
                                             int64_t until_ns) {
  group_ = group;
  const int64_t begin_ns = Now_ns(CLOCK_MONOTONIC);
  Patience patience(begin_ns);
  for (bool told = false;
       AwaitsAnEnd() && ended_.empty() && trouble_.empty() && !ProcessGroup::StopRequested();) {
    if (const auto ended = group->Poll(milliseconds(50))) NoteEnd(*ended);
    if (!AwaitsAnEnd()) continue;
    const int64_t now_ns = Now_ns(CLOCK_MONOTONIC);
    const pid_t pid = group->Find(WhoseEndIsAwaited()).value_or(0);
    const int64_t waited_ns = patience.Look(pid, now_ns);
    if (now_ns - begin_ns < kTold_ns) continue;
    const std::string who = Describe(WhoseEndIsAwaited(), pid);
    if (!told) std::cerr << "armada run: waiting for the end of " << who << std::endl;
    told = true;
    if (waited_ns > kHung_ns)
      trouble_ = who + " has left the run " + Seconds(now_ns - begin_ns) + " ago and does not end";
  }
  if (ended_.empty() && trouble_.empty()) Wait(inputs, until_ns);
  if (ended_.empty()) return std::nullopt;
  const ProcessExit first = ended_.front();
  ended_.pop_front();
  return first;
}

bool SteppedTime::NoteEnd(const ProcessExit& ended) {
  const ClockPage::Slot* const slot = Find(ended.name);
  ended_.push_back(ended);
  if (slot == nullptr) return true;
  running_[static_cast<size_t>(slot - page()->slot.data() - 1)] = false;
  return slot->state == State::kGone;
}

bool SteppedTime::MayWaitOn() {
  if (group_ == nullptr) return true;
  while (const auto ended = group_->Poll()) {
    if (!NoteEnd(*ended)) return false;
  }
  return !ProcessGroup::StopRequested() && HolderGetsOn();
}

bool SteppedTime::HolderGetsOn() {
  const uint32_t holder = page()->holder;
  if (holder == 0 || holder > programs_.size()) return true;
  const pid_t pid = page()->slot[holder].pid;
  const int64_t now_ns = Now_ns(CLOCK_MONOTONIC);
  if (page()->turns != turn_) {
    turn_ = page()->turns;
    turn_since_ns_ = now_ns;
    turn_patience_ = Patience(now_ns);
    turn_cpu_ns_ = ProcessorTime(pid);
    told_ = false;
    return true;
  }
  const int64_t since_ns = now_ns - turn_since_ns_;
  const int64_t waited_ns = turn_patience_.Look(pid, now_ns);
  if (since_ns < kTold_ns) return true;
  const int64_t cpu_ns = ProcessorTime(pid) - turn_cpu_ns_;
  const std::string& program = programs_[holder - 1];
  if (cpu_ns > kHung_cpu_ns || (waited_ns > kHung_ns && DoingOf(pid) == Doing::kAsleep)) {
    char at[32];
    std::snprintf(at, sizeof at, "%.3f", stepped_s());
    trouble_ = program + " (pid " + std::to_string(pid) + ") hangs: its turn at " + at +
               " s of stepped time has lasted " + Seconds(since_ns) + ", " + Seconds(cpu_ns) +
               " of them on a processor";
    return false;
  }
  if (!told_) std::cerr << "armada run: waiting for " << Describe(program, pid) << std::endl;
  told_ = true;
  return true;
}

bool SteppedTime::Kill(ProcessGroup* group, const std::string& program) {
  ClockPage::Slot* const slot = Find(program);
  if (slot == nullptr || !group->Signal(program, SIGKILL)) return false;
  slot->state = State::kGone;
  return true;
}

bool SteppedTime::Suspend(const std::string& program, bool suspended) {
  ClockPage::Slot* const slot = Find(program);
  if (slot == nullptr || slot->state == State::kGone) return false;
  slot->suspended = suspended;
  return true;
}

void SteppedTime::Release() {
  if (released()) return;
  page()->released_ns = Now_ns(CLOCK_MONOTONIC);
  for (size_t i = 1; i <= programs_.size(); ++i) {
    page()->slot[i].turn = 1;
    Wake(&page()->slot[i].turn);
  }
}

double SteppedTime::stepped_s() const {
  return 1e-9 * static_cast<double>(page()->now_ns - kStart_ns);
}

double SteppedTime::real_s() const {
  return began_ns_ == 0 ? 0.0 : 1e-9 * static_cast<double>(Now_ns(CLOCK_MONOTONIC) - began_ns_);
}

}  // namespace armada
