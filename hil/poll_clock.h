#pragma once

#include <poll.h>

#include <memory>
#include <string>
#include <vector>

#include "firmware/can/bus.h"
#include "firmware/clock/clock.h"
#include "firmware/unique_fd.h"
#include "hil/hil_clock.h"

namespace armada {

/// The program's clock. Waits on every bus; SIGINT and SIGTERM end the run.
class PollClock final : public HilClock {
 public:
  /// Blocks the two signals in this thread, and so in the threads that it starts later, and takes them as
  /// input instead: no handler, and none is missed between two waits. `clock` outlives the object. Null, and
  /// the reason in `error`, on failure.
  static std::unique_ptr<PollClock> Create(const std::vector<std::unique_ptr<CanBus>>& buses, Clock* clock,
                                           std::string* error);

  int64_t Now() override;
  bool WaitUntil(int64_t deadline_ns) override;

 private:
  PollClock(UniqueFd signals, Clock* clock) : signals_(std::move(signals)), clock_(clock) {}

  UniqueFd signals_;
  Clock* clock_;
  std::vector<pollfd> inputs_;  ///< the signals' first
};

}  // namespace armada
