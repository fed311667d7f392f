#include "hil/poll_clock.h"

#include <sys/signalfd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>

#include "firmware/app/realtime.h"

namespace armada {

std::unique_ptr<PollClock> PollClock::Create(const std::vector<std::unique_ptr<CanBus>>& buses,
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
  std::unique_ptr<PollClock> clock(new PollClock(std::move(signals)));
  clock->inputs_.push_back({clock->signals_.get(), POLLIN, 0});
  for (const auto& bus : buses) clock->inputs_.push_back({bus->descriptor(), POLLIN, 0});
  return clock;
}

int64_t PollClock::Now() {
  return MonotonicNow();
}

bool PollClock::WaitUntil(int64_t deadline_ns) {
  constexpr int64_t kNsPerS = 1'000'000'000;
  const int64_t left_ns = std::max<int64_t>(0, deadline_ns - Now());
  const timespec left{left_ns / kNsPerS, left_ns % kNsPerS};
  inputs_.front().revents = 0;
  ppoll(inputs_.data(), inputs_.size(), &left, nullptr);
  return inputs_.front().revents == 0;
}

}  // namespace armada
