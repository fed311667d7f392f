#include "hil/poll_clock.h"

#include <sys/signalfd.h>

#include <cerrno>
#include <csignal>
#include <cstring>

namespace armada {

std::unique_ptr<PollClock> PollClock::Create(const std::vector<std::unique_ptr<CanBus>>& buses, Clock* clock,
                                             std::string* error) {
  sigset_t stop;
  sigemptyset(&stop);
  sigaddset(&stop, SIGINT);
  sigaddset(&stop, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &stop, nullptr);
  UniqueFd signals(signalfd(-1, &stop, SFD_CLOEXEC | SFD_NONBLOCK));
  if (!signals.valid()) {
    *error = std::string("cannot receive signals: ") + std::strerror(errno);
    return nullptr;
  }
  std::unique_ptr<PollClock> made(new PollClock(std::move(signals), clock));
  made->inputs_.push_back({made->signals_.get(), POLLIN, 0});
  for (const auto& bus : buses) made->inputs_.push_back({bus->descriptor(), POLLIN, 0});
  return made;
}

int64_t PollClock::Now() {
  return clock_->Now();
}

bool PollClock::WaitUntil(int64_t deadline_ns) {
  inputs_.front().revents = 0;
  clock_->Wait(inputs_, deadline_ns);
  return inputs_.front().revents == 0;
}

}  // namespace armada
