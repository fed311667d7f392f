#include "firmware/app/bus_watch.h"

namespace armada {

void BusWatch::OnBus(BusStatus status) {
  switch (status) {
    case BusStatus::kOk:
    case BusStatus::kTimeout:
    case BusStatus::kQueueFull:  // counted by the bus; OnSent judges what was dropped
      return;
    case BusStatus::kErrorPassive:
      error_passive_ = true;
      return;
    case BusStatus::kErrorActive:
      error_passive_ = false;
      return;
    case BusStatus::kBusOff:
      new_.Add(Cause::kBusOff);
      return;
    case BusStatus::kRestarted:
      new_.Add(Cause::kBusRestarted);
      return;
    case BusStatus::kDown:
      new_.Add(Cause::kBusDown);
      return;
  }
}

void BusWatch::OnSent(bool all) {
  unsent_in_a_row_ = all ? 0 : unsent_in_a_row_ + 1;
}

void BusWatch::OnTick(int64_t tick_ns, double ready_s, int64_t missed) {
  new_.Set(Cause::kTickOverrun, ready_s > supervisor_.overrun_share * timing_.period_s);
  new_.Set(Cause::kTicksMissed, missed >= supervisor_.missed_in_a_row);
  for (int64_t i = 0; i < missed && i < supervisor_.missed_in_a_second; ++i) {
    missed_at_ns_[next_missed_] = tick_ns;
    next_missed_ = (next_missed_ + 1) % static_cast<size_t>(supervisor_.missed_in_a_second);
  }
}

CauseSet BusWatch::Take(int64_t tick_ns) {
  CauseSet causes = new_;
  new_ = {};
  causes.Set(Cause::kTorquesLate, unsent_in_a_row_ > 0);
  causes.Set(Cause::kTorquesUnsent, unsent_in_a_row_ >= timing_.transmit_failures_max);
  error_passive_s_ = error_passive_ ? error_passive_s_ + timing_.period_s : 0.0;
  causes.Set(Cause::kErrorPassive, error_passive_);
  causes.Set(Cause::kErrorPassiveLong, error_passive_s_ > supervisor_.error_passive_max_s);
  const int64_t oldest_ns = missed_at_ns_[next_missed_];
  causes.Set(Cause::kTicksMissed, oldest_ns != 0 && tick_ns - oldest_ns <= 1'000'000'000);
  return causes;
}

}  // namespace armada
