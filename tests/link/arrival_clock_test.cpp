#include "firmware/link/arrival_clock.h"

#include <gtest/gtest.h>

#include "tests/support/numbers.h"

namespace armada {
namespace {

constexpr int64_t kWall = 1'700'000'000'000 * kMs;  // wall clock at monotonic zero
constexpr int64_t kHour = 3'600'000 * kMs;

TEST(ArrivalClock, MovesWallClockStampsToTheMonotonicClock) {
  ArrivalClock clock;
  clock.Update(kWall + 100 * kMs, 100 * kMs);
  clock.Update(kWall + 110 * kMs, 110 * kMs);
  EXPECT_EQ(clock.ToMonotonic(kWall + 103 * kMs), 103 * kMs);
  EXPECT_EQ(clock.now_ns(), 110 * kMs);
}

TEST(ArrivalClock, FollowsSlewing) {
  ArrivalClock clock;
  clock.Update(kWall, 0);
  clock.Update(kWall + 10 * kMs + 5000, 10 * kMs);  // 500 ppm fast
  EXPECT_EQ(clock.ToMonotonic(kWall + 10 * kMs + 5000 - 2 * kMs), 8 * kMs);
}

TEST(ArrivalClock, NeverAnswersLaterThanNow) {
  ArrivalClock clock;
  clock.Update(kWall, 0);
  clock.Update(kWall + 10 * kMs, 10 * kMs);
  EXPECT_EQ(clock.ToMonotonic(kWall + 11 * kMs), 10 * kMs);
}

TEST(ArrivalClock, TakesTheTimeOfTheBatchAfterAStepOfTheWallClock) {
  for (const int64_t step : {kHour, -kHour, 2 * kMs, -2 * kMs}) {
    ArrivalClock clock;
    clock.Update(kWall, 0);
    clock.Update(kWall + step + 10 * kMs, 10 * kMs);
    EXPECT_EQ(clock.ToMonotonic(kWall + 4 * kMs), 10 * kMs) << step;         // stamped before the step
    EXPECT_EQ(clock.ToMonotonic(kWall + step + 9 * kMs), 10 * kMs) << step;  // and after

    clock.Update(kWall + step + 20 * kMs, 20 * kMs);
    EXPECT_EQ(clock.ToMonotonic(kWall + step + 13 * kMs), 13 * kMs) << step;
  }
}

}  // namespace
}  // namespace armada
