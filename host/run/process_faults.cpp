#include "host/run/process_faults.h"

#include <sched.h>

#include <algorithm>
#include <cmath>

#include "host/run/link_switch.h"

namespace armada {
namespace {

// A fault strikes at its time, and be it in the middle of a tick: before boards and emulation.
constexpr int kPriority = 95;
// Before it, so that the ordinary scheduler has time to let this process take that priority.
constexpr int64_t kLead_ns = 20'000'000;

/// Before all other programs, while it lives; programs started meanwhile are not. Without the right to,
/// faults are made a little later, as Made tells.
class Foremost {
 public:
  Foremost() { Take(SCHED_FIFO, kPriority); }
  Foremost(const Foremost&) = delete;
  Foremost& operator=(const Foremost&) = delete;
  ~Foremost() { Take(SCHED_OTHER, 0); }

 private:
  static void Take(int policy, int priority) {
    const sched_param parameters{.sched_priority = priority};
    sched_setscheduler(0, policy | SCHED_RESET_ON_FORK, &parameters);
  }
};

}  // namespace

ProcessFaults::ProcessFaults(const std::vector<FaultConfig>& faults,
                             const std::map<int, std::string>& interfaces, Clock* clock, int64_t epoch_ns,
                             int64_t end_ns)
    : interfaces_(interfaces),
      clock_(clock),
      lead_ns_(clock->IsStepped() ? 0 : kLead_ns),
      epoch_ns_(epoch_ns),
      end_ns_(end_ns) {
  for (const FaultConfig& fault : faults) Add(fault);
}

void ProcessFaults::Add(const FaultConfig& fault) {
  Plan(fault);
  std::stable_sort(steps_.begin() + static_cast<std::ptrdiff_t>(next_), steps_.end(),
                   [](const Step& a, const Step& b) { return a.at_ns < b.at_ns; });
}

ProcessFaults::~ProcessFaults() {
  std::string ignored;
  for (const int arm_id : down_) SetLinkUp(interfaces_.at(arm_id), true, &ignored);
}

int64_t ProcessFaults::TimeOf(double t_s) const {
  return epoch_ns_ + std::llround(t_s * 1e9);
}

void ProcessFaults::AddStep(double at_s, Deed deed, int arm_id) {
  if (const int64_t at_ns = TimeOf(at_s); at_ns < end_ns_) steps_.push_back({at_ns, deed, arm_id});
}

void ProcessFaults::Plan(const FaultConfig& fault) {
  switch (fault.kind) {
    case FaultKind::kControllerDies:
    case FaultKind::kLeaderDies:
      AddStep(fault.at_s, Deed::kKill, fault.arm);
      break;
    case FaultKind::kControllerRestarts:
      AddStep(fault.at_s, Deed::kKill, fault.arm);
      AddStep(fault.until_s, Deed::kStart, fault.arm);
      break;
    case FaultKind::kControllerStops:
    case FaultKind::kLeaderStops:
      AddStep(fault.at_s, Ends(fault) ? Deed::kStop : Deed::kStopForGood, fault.arm);
      AddStep(fault.until_s, Deed::kContinue, fault.arm);
      break;
    case FaultKind::kBusDown:
      if (!interfaces_.contains(fault.arm)) break;  // the emulation lets no frame pass
      AddStep(fault.at_s, Deed::kLinkDown, fault.arm);
      AddStep(fault.until_s, Deed::kLinkUp, fault.arm);
      break;
    case FaultKind::kCpuHog:
      if (lead_ns_ == 0) break;  // stepped: whoever computes is waited for
      hogs_.emplace_back(static_cast<int>(fault.value), TimeOf(fault.at_s),
                         std::min(TimeOf(fault.until_s), end_ns_));
      break;
    default:
      break;  // not of a process
  }
}

int64_t ProcessFaults::Next() const {
  return next_ == steps_.size() ? INT64_MAX : steps_[next_].at_ns - lead_ns_;
}

// Signals of children end a sleep early.
void ProcessFaults::SleepThrough(int64_t until_ns) const {
  while (clock_->Now() < until_ns) clock_->SleepUntil(until_ns);
}

bool ProcessFaults::MakeDue(ProgramControl* control,
                            const std::function<bool(int arm_id, std::string* error)>& start,
                            std::string* error) {
  const auto is_due = [&] { return Next() <= clock_->Now(); };
  if (!is_due()) return true;
  std::optional<Foremost>
      foremost;  // until the last: of two close together the second has no lead of its own
  if (lead_ns_ > 0) foremost.emplace();
  do {
    const Step step = steps_[next_++];
    SleepThrough(step.at_ns);
    const double made_s = 1e-9 * static_cast<double>(clock_->Now() - epoch_ns_);
    if (!Make(step, control, start, error)) return false;
    const bool link = step.deed == Deed::kLinkDown || step.deed == Deed::kLinkUp;
    made_.push_back({NameOf(step.deed), link ? interfaces_.at(step.arm_id) : ProcessOf(step.arm_id),
                     1e-9 * static_cast<double>(step.at_ns - epoch_ns_), made_s});
  } while (is_due());
  return true;
}

bool ProcessFaults::Make(const Step& step, ProgramControl* control,
                         const std::function<bool(int arm_id, std::string* error)>& start,
                         std::string* error) {
  switch (step.deed) {
    case Deed::kKill:
      Kill(step.arm_id, control);
      return true;
    case Deed::kStopForGood:
      if (control->Stop(ProcessOf(step.arm_id))) stopped_for_good_.insert(step.arm_id);
      return true;
    case Deed::kStop:
      control->Stop(ProcessOf(step.arm_id));
      return true;
    case Deed::kContinue:
      control->Continue(ProcessOf(step.arm_id));
      stopped_for_good_.erase(step.arm_id);
      return true;
    case Deed::kStart:
      if (dead_arms_.erase(step.arm_id) == 0) return true;  // another fault has started it already
      return start(step.arm_id, error);
    case Deed::kLinkDown:
      return Switch(step.arm_id, false, error);
    case Deed::kLinkUp:
      return Switch(step.arm_id, true, error);
  }
  return true;
}

void ProcessFaults::Kill(int arm_id, ProgramControl* control) {
  if (!control->Kill(ProcessOf(arm_id))) return;  // it is dead already
  ordered_.insert(ProcessOf(arm_id));
  stopped_for_good_.erase(arm_id);
  if (arm_id != 0) dead_arms_.insert(arm_id);
}

bool ProcessFaults::Switch(int arm_id, bool up, std::string* error) {
  if (!SetLinkUp(interfaces_.at(arm_id), up, error)) return false;
  if (up) {
    down_.erase(arm_id);
  } else {
    down_.insert(arm_id);
  }
  return true;
}

bool ProcessFaults::TakeOrdered(const ProcessExit& ended) {
  const auto found = ordered_.find(ended.name);
  if (found == ordered_.end()) return false;
  ordered_.erase(found);
  return true;
}

void ProcessFaults::KillStopped(ProgramControl* control) {
  const std::set<int> stopped = stopped_for_good_;
  for (const int arm_id : stopped) Kill(arm_id, control);
}

const char* ProcessFaults::NameOf(Deed deed) {
  switch (deed) {
    case Deed::kKill:
      return "killed";
    case Deed::kStop:
    case Deed::kStopForGood:
      return "stopped";
    case Deed::kContinue:
      return "continued";
    case Deed::kStart:
      return "started";
    case Deed::kLinkDown:
      return "down";
    case Deed::kLinkUp:
      break;
  }
  return "up";
}

}  // namespace armada
