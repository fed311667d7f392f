#include "firmware/app/duration_histogram.h"

#include <gtest/gtest.h>

namespace armada {
namespace {

TEST(DurationHistogram, GivesPercentilesInMicroseconds) {
  DurationHistogram histogram;
  for (int64_t us = 1; us <= 1000; ++us) histogram.Add(us * 1000);
  EXPECT_EQ(histogram.count(), 1000);
  EXPECT_EQ(histogram.PercentileUs(0.5), 500);
  EXPECT_EQ(histogram.PercentileUs(0.99), 990);
  EXPECT_EQ(histogram.PercentileUs(0.999), 999);
  EXPECT_EQ(histogram.max_us(), 1000);
}

TEST(DurationHistogram, KeepsTheExactMaximumBeyondItsBins) {
  DurationHistogram histogram;
  histogram.Add(5'000'000'123);
  EXPECT_DOUBLE_EQ(histogram.max_us(), 5'000'000.123);
  EXPECT_EQ(histogram.PercentileUs(1.0), 19'999);
}

TEST(DurationHistogram, IsZeroWhenEmpty) {
  const DurationHistogram histogram;
  EXPECT_EQ(histogram.PercentileUs(0.99), 0);
  EXPECT_EQ(histogram.max_us(), 0);
}

}  // namespace
}  // namespace armada
