#include "firmware/link/clock_offset.h"

#include <algorithm>
#include <limits>

namespace armada {
namespace {

constexpr int64_t kNone = std::numeric_limits<int64_t>::max();

int64_t ToNs(double seconds) {
  return static_cast<int64_t>(1e9 * seconds);
}

}  // namespace

ClockOffset::ClockOffset(const Config& config) : config_(config) {}

Freshness ClockOffset::Update(const MessageTime& message) {
  const MessageTime& newest = state_.newest;
  const bool newer = message.sequence > newest.sequence && message.stamp_ns > newest.stamp_ns;
  const bool silent = message.arrival_ns - newest.arrival_ns >= ToNs(config_.silence_s);
  if (!state_.heard || (!newer && silent)) {
    Forget(message);
    return Freshness::kRestarted;
  }
  if (!newer) return Freshness::kStale;

  const int64_t elapsed_ns = message.arrival_ns - state_.window_start_ns;
  const int64_t window_ns = ToNs(config_.window_s);
  if (elapsed_ns >= window_ns) {
    state_.previous_min_ns = elapsed_ns < 2 * window_ns ? state_.window_min_ns : kNone;
    state_.window_min_ns = kNone;
    state_.window_start_ns = message.arrival_ns;
  }
  state_.window_min_ns = std::min(state_.window_min_ns, message.arrival_ns - message.stamp_ns);
  state_.newest = message;
  return Freshness::kNew;
}

double ClockOffset::AgeS(int64_t stamp_ns, int64_t now_ns) const {
  if (!state_.heard) return std::numeric_limits<double>::infinity();
  const int64_t offset_ns = std::min(state_.window_min_ns, state_.previous_min_ns);
  return static_cast<double>(now_ns - stamp_ns - offset_ns) / 1e9 + config_.wire_time_s;
}

void ClockOffset::Forget(const MessageTime& message) {
  state_.heard = true;
  state_.newest = message;
  state_.window_start_ns = message.arrival_ns;
  state_.window_min_ns = message.arrival_ns - message.stamp_ns;
  state_.previous_min_ns = kNone;
}

}  // namespace armada
