#include "host/run/heartbeat.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "firmware/app/realtime.h"
#include "tests/support/numbers.h"

namespace armada {
namespace {

int64_t Length(const Stall& stall) {
  return stall.end_ns - stall.begin_ns;
}

void SleepFor(int64_t duration_ns) {
  SleepUntil(MonotonicNow() + duration_ns);
}

// A process of its own, which is stopped: a stop of every program looks like that. Exits with 0 when its
// heartbeat has noticed just that.
[[noreturn]] void WatchAStop(int64_t stopped_ns) {
  Heartbeat heartbeat(stopped_ns / 2);
  const int64_t before_ns = MonotonicNow();
  SleepFor(20 * kMs);
  raise(SIGSTOP);
  const int64_t after_ns = MonotonicNow();
  SleepFor(20 * kMs);
  heartbeat.Stop();
  int noticed = 0;
  for (const Stall& stall : heartbeat.Stalls()) {
    const bool within = stall.begin_ns > before_ns && stall.begin_ns < after_ns;
    if (within && stall.processors == heartbeat.processors() && Length(stall) > stopped_ns * 9 / 10)
      ++noticed;
  }
  _exit(noticed == 1 ? 0 : 1);
}

TEST(HeartbeatTest, AStopOfTheProcessIsOneStallOfEveryProcessor) {
  constexpr int64_t kStopped_ns = 200 * kMs;
  const pid_t child = fork();
  if (child == 0) WatchAStop(kStopped_ns);
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, WUNTRACED), child);
  ASSERT_TRUE(WIFSTOPPED(status));
  SleepFor(kStopped_ns);
  kill(child, SIGCONT);
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

TEST(HeartbeatTest, WhatIsShorterThanTheThresholdIsNone) {
  Heartbeat heartbeat(10'000 * kMs);
  SleepFor(20 * kMs);
  heartbeat.Stop();
  EXPECT_TRUE(heartbeat.Stalls().empty());
  EXPECT_GE(heartbeat.processors(), 1);
}

TEST(HeartbeatTest, StallsOfSeveralProcessorsAreOneWhereTheyOverlap) {
  const auto joined = Joined({{100, 200, 1, 1}, {0, 50, 1, 0}, {95, 210, 1, 0}, {205, 260, 1, 1}});
  ASSERT_EQ(joined.size(), 3u);
  EXPECT_EQ(joined[0].processors, 1);
  EXPECT_EQ(joined[1].begin_ns, 95);
  EXPECT_EQ(joined[1].end_ns, 210);
  EXPECT_EQ(joined[1].processors, 2);
  EXPECT_EQ(joined[2].begin_ns, 205) << "two that only touch are two";
}

}  // namespace
}  // namespace armada
