#include "firmware/link/silence_watch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace armada {
namespace {

constexpr int64_t kPeriodNs = 10'000'000;

TEST(SilenceWatch, ASenderWithoutLossesIsMissedAfterAFewMessages) {
  SilenceWatch watch{SilenceWatch::Config(), 0};
  EXPECT_FALSE(watch.IsSilent(0)) << "it was never heard";
  for (int64_t k = 1; k <= 100; ++k) {
    watch.OnMessage(k, k * kPeriodNs, k * kPeriodNs);
    ASSERT_FALSE(watch.IsSilent((k + 1) * kPeriodNs));
  }
  EXPECT_FALSE(watch.IsSilent(107 * kPeriodNs));
  EXPECT_TRUE(watch.IsSilent(108 * kPeriodNs));
}

TEST(SilenceWatch, ASenderThatNeverSpeaksOrSpeaksOnceIsMissedAfterASecond) {
  SilenceWatch never{SilenceWatch::Config(), 5'000'000'000};
  EXPECT_FALSE(never.IsSilent(5'990'000'000));
  EXPECT_TRUE(never.IsSilent(6'010'000'000));
  SilenceWatch once{SilenceWatch::Config(), 0};
  once.OnMessage(1, 500'000'000, 500'000'000);
  EXPECT_FALSE(once.IsSilent(1'490'000'000));
  EXPECT_TRUE(once.IsSilent(1'510'000'000));
}

TEST(SilenceWatch, ASlowSenderHasItsOwnTime) {
  SilenceWatch watch{SilenceWatch::Config(), 0};
  for (int64_t k = 1; k <= 10; ++k) watch.OnMessage(k, 10 * k * kPeriodNs, 10 * k * kPeriodNs);
  EXPECT_FALSE(watch.IsSilent(165 * kPeriodNs));
  EXPECT_TRUE(watch.IsSilent(175 * kPeriodNs));
}

TEST(SilenceWatch, LossesAreNotTakenForDeathAndDeathIsNoticedAllTheSame) {
  std::mt19937 random(1);
  for (const double loss : {0.05, 0.3, 0.5}) {
    SilenceWatch watch{SilenceWatch::Config(), 0};
    int alarms = 0;
    int64_t longest = 0;
    int64_t last = 0;
    constexpr int64_t kMessages = 1'000'000;
    for (int64_t k = 1; k <= kMessages; ++k) {
      alarms += watch.IsSilent(k * kPeriodNs);
      if (k > 1 && std::bernoulli_distribution(loss)(random)) continue;
      longest = std::max(longest, k - last);
      last = k;
      watch.OnMessage(k, k * kPeriodNs, k * kPeriodNs);
    }
    EXPECT_LE(alarms, 3) << "loss " << loss << ", longest gap " << longest;
    EXPECT_TRUE(watch.IsSilent((kMessages + 45) * kPeriodNs)) << "loss " << loss;
  }
}

}  // namespace
}  // namespace armada
