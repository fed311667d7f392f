// A small program of a run in stepped time, for tests of the clock: a role, and a log of what it sees when.
//
// usage: stepped_actor LOG ROLE NUMBER... --stepped-clock FILE:SLOT; times in ms from the start
//   speak PERIOD COUNT   sends frames 0, 1, .. on the bus
//   answer UNTIL         answers each frame at once with one of its number + 100
//   read PERIOD UNTIL    sleeps, and takes every PERIOD what has come; logs when it came
//   die AT | hang AT     does so

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "firmware/app/program_clock.h"
#include "firmware/can/open_bus.h"

namespace armada {
namespace {

constexpr int64_t kMs = 1'000'000;
constexpr const char* kBus = "udp:239.74.163.77:43177";

class Actor {
 public:
  Actor(char** words, Clock* clock, CanBus* bus)
      : words_(words), clock_(clock), bus_(bus), log_(std::fopen(words[1], "a")), begin_ns_(clock->Now()) {
    std::setvbuf(log_, nullptr, _IOLBF, 0);
  }
  Actor(const Actor&) = delete;
  Actor& operator=(const Actor&) = delete;
  ~Actor() { std::fclose(log_); }

  void Act() {
    const std::string role = words_[2];
    if (role == "speak") Speak();
    if (role == "answer") Answer();
    if (role == "read") Read();
    clock_->SleepUntil(Number(0));
    if (role == "die") std::abort();
    for (volatile bool hangs = role == "hang"; hangs;) {
    }
  }

 private:
  int64_t Number(int index) const { return begin_ns_ + std::llround(std::stod(words_[3 + index]) * kMs); }
  void Log(const char* what, uint32_t number, int64_t at_ns) {
    std::fprintf(log_, "%.3f %s %u %.3f\n", static_cast<double>(clock_->Now() - begin_ns_) / kMs, what,
                 number, static_cast<double>(at_ns - begin_ns_) / kMs);
  }
  void Send(uint32_t number) {
    CanFrame frame;
    frame.id = number;
    frame.extended = true;
    if (bus_->Send(frame) != BusStatus::kOk) std::abort();
  }

  void Speak() {
    const int64_t period_ns = Number(0) - begin_ns_;
    for (int k = 0; k < std::atoi(words_[4]); ++k) {
      clock_->SleepUntil(begin_ns_ + (k + 1) * period_ns);
      Log("spoke", static_cast<uint32_t>(k), clock_->Now());
      Send(static_cast<uint32_t>(k));
    }
  }
  void Answer() {
    CanFrame frame;
    while (bus_->Receive(Number(0), &frame) == BusStatus::kOk) {
      if (frame.id >= 100) continue;
      Log("answered", frame.id, frame.stamp_ns);
      Send(frame.id + 100);
    }
  }
  void Read() {
    const int64_t period_ns = Number(0) - begin_ns_;
    for (int64_t at_ns = begin_ns_ + period_ns; at_ns <= Number(1); at_ns += period_ns) {
      clock_->SleepUntil(at_ns);
      CanFrame frame;
      while (bus_->Receive(0, &frame) == BusStatus::kOk) Log("read", frame.id, frame.stamp_ns);
    }
  }

  char** words_;
  Clock* clock_;
  CanBus* bus_;
  std::FILE* log_;
  int64_t begin_ns_;
};

}  // namespace
}  // namespace armada

int main(int argc, char** argv) {
  using namespace armada;
  std::string error;
  const auto clock = OpenProgramClock(argv[argc - 1], LcmUrl(), {kBus}, &error);
  const auto bus = clock ? OpenBus(kBus, {}, clock.get(), &error) : nullptr;
  if (!bus) {
    std::fprintf(stderr, "%s\n", error.c_str());
    return 1;
  }
  Actor(argv, clock.get(), bus.get()).Act();
  return 0;
}
