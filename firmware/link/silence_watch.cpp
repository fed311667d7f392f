#include "firmware/link/silence_watch.h"

#include <algorithm>
#include <cmath>

namespace armada {

void SilenceWatch::OnMessage(int64_t sequence, int64_t stamp_ns, int64_t arrival_ns) {
  const int64_t count = sequence - sequence_;
  const int64_t elapsed_ns = stamp_ns - stamp_ns_;
  if (heard_ && count > 0 && elapsed_ns > 0) {
    const auto sent = static_cast<double>(count);
    period_s_ = 1e-9 * static_cast<double>(elapsed_ns) / sent;
    const double kept = std::pow(1.0 - 1.0 / config_.memory, sent);
    loss_ = std::min(config_.loss_max, kept * loss_ + (1.0 - kept) * (sent - 1.0) / sent);
    // loss^n = chance
    const double by_chance = loss_ > 0.0 ? std::log(config_.chance) / std::log(loss_) : 0.0;
    allowed_ = std::max(static_cast<double>(config_.messages), by_chance);
  }
  heard_ = true;
  sequence_ = sequence;
  stamp_ns_ = stamp_ns;
  arrival_ns_ = arrival_ns;
}

}  // namespace armada
