#include "host/run/board_lateness.h"

#include <algorithm>
#include <cstdio>

#include "host/run/run_finding.h"

namespace armada {
namespace {

std::string Milliseconds(double duration_s) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f ms", duration_s * 1e3);
  return text;
}

void Widen(BoardLateness::Largest* largest, double value, double at_s) {
  if (value > largest->value) *largest = {value, at_s};
}

}  // namespace

double TolerableLateness_s(const TimingConfig& timing) {
  return std::min(timing.feedback_timeout_s, timing.transmit_timeout_s);
}

BoardLateness LatenessBetween(std::span<const telemetry_t> ticks, double period_s, int64_t epoch_ns,
                              double from_s, double to_s) {
  BoardLateness lateness;
  int64_t most_missed = 0;
  for (size_t i = 0; i < ticks.size(); ++i) {
    const telemetry_t& tick = ticks[i];
    const double at_s = 1e-9 * static_cast<double>(tick.stamp_ns - epoch_ns);
    if (at_s < from_s || at_s > to_s) continue;
    const telemetry_t none{};  // before its first tick, also after a new start, a board has counted nothing
    const bool is_first = i == 0 || tick.sequence <= ticks[i - 1].sequence;
    const telemetry_t& last = is_first ? none : ticks[i - 1];
    const int64_t missed = tick.missed_ticks - last.missed_ticks;
    lateness.missed_ticks += missed;
    if (missed > most_missed) {
      most_missed = missed;
      lateness.missed_at_s = at_s;
    }
    Widen(&lateness.wakeup_s, 1e-6 * tick.wakeup_lateness_us, at_s);
    Widen(&lateness.sample_to_torque_s, 1e-6 * tick.sample_to_torque_us, at_s);
    const int64_t last_ns = i == 0 ? epoch_ns : ticks[i - 1].stamp_ns;
    const double since_last_s = 1e-9 * static_cast<double>(tick.stamp_ns - last_ns);
    const int64_t unheard = tick.sequence - last.sequence - 1;
    Widen(&lateness.silent_s, since_last_s - static_cast<double>(missed + unheard) * period_s, at_s);
    lateness.can_dropped += tick.can_dropped - last.can_dropped;
    lateness.lcm_rejected += tick.lcm_rejected - last.lcm_rejected;
  }
  return lateness;
}

std::string BoardLateness::Text(const TimingConfig& timing) const {
  std::string text;
  const auto add = [&](const std::string& words) { text += (text.empty() ? "" : ", ") + words; };
  const double tolerable_s = TolerableLateness_s(timing);
  if (missed_ticks > 0) {
    add(std::to_string(missed_ticks) + (missed_ticks == 1 ? " tick" : " ticks") + " missed at " +
        TimeText(missed_at_s));
  }
  if (wakeup_s.value >= tolerable_s)
    add("woken " + Milliseconds(wakeup_s.value) + " late at " + TimeText(wakeup_s.at_s));
  if (sample_to_torque_s.value >= tolerable_s) {
    add(Milliseconds(sample_to_torque_s.value) + " from sample to torque at " +
        TimeText(sample_to_torque_s.at_s));
  }
  if (silent_s.value >= 3.0 * timing.period_s)
    add("not heard for " + Milliseconds(silent_s.value) + " until " + TimeText(silent_s.at_s));
  if (can_dropped > 0) add(std::to_string(can_dropped) + " CAN frames dropped");
  if (lcm_rejected > 0) add(std::to_string(lcm_rejected) + " LCM messages rejected");
  return text;
}

}  // namespace armada
