#pragma once

#include <poll.h>

#include <memory>
#include <string>
#include <vector>

#include "firmware/can/bus.h"
#include "firmware/unique_fd.h"
#include "hil/hil_clock.h"

namespace armada {

/// The machine's clock. Waits in ppoll on every bus; SIGINT and SIGTERM end the run.
class PollClock final : public HilClock {
 public:
  /// Blocks the two signals in this thread, and so in the threads that it starts later, and takes them as
  /// input instead: no handler, and none is missed between two waits. Null, and the reason in `error`, on
  /// failure.
  static std::unique_ptr<PollClock> Create(const std::vector<std::unique_ptr<CanBus>>& buses,
                                           std::string* error);

  int64_t Now() override;
  bool WaitUntil(int64_t deadline_ns) override;

 private:
  explicit PollClock(UniqueFd signals) : signals_(std::move(signals)) {}

  UniqueFd signals_;
  std::vector<pollfd> inputs_;  ///< the signals' first
};

}  // namespace armada
