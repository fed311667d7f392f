#include "host/sweep/sweep_summary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "host/sweep/seed_range.h"
#include "tests/host/sweep_samples.h"

namespace armada {
namespace {

TEST(SweepSummary, CountsFailuresAndNamesTheWorstSeed) {
  std::vector<SeedResult> runs;
  for (uint64_t seed = 1; seed <= 99; ++seed)
    runs.push_back(ResultOf(seed, 0.5 + 0.001 * static_cast<double>(seed), true));
  runs.push_back(ResultOf(100, 900.0, false));
  const SweepSummary summary = Summarize(SweepOf(runs).results);
  EXPECT_EQ(summary.count, 100);
  EXPECT_EQ(summary.ok_count, 99);
  EXPECT_EQ(summary.failed_seeds, std::vector<uint64_t>{100});
  ASSERT_TRUE(summary.fleet_rms_mm.has_value());
  EXPECT_LT(*summary.fleet_rms_mm, 1.0) << "over the fleets that are ok";
  EXPECT_EQ(summary.fleet_rms_all_mm.worst_seed, 100u);
  ASSERT_EQ(summary.arms.size(), 1u);
  EXPECT_EQ(summary.arms[0].diverged, 1);
  EXPECT_EQ(summary.arms[0].never_settled, 1);
  EXPECT_EQ(summary.arms[0].rms_mm.worst_seed, 99u);
  EXPECT_NEAR(summary.arms[0].rms_mm.median, 0.55, 1e-9);
}

TEST(SweepSummary, ListsTheWorstFleetsWorstFirstAndNoneThatDiverged) {
  const SweepSummary summary = Summarize(
      SweepOf({ResultOf(1, 0.3, true), ResultOf(2, 0.9, true), ResultOf(3, 0.5, true), ResultOf(4, 0.4, true),
               ResultOf(5, 700.0, false), ResultOf(6, 0.8, true), ResultOf(7, 0.1, true)})
          .results);
  std::vector<uint64_t> seeds;
  for (const WorstSeed& worst : summary.worst_rms_mm.list()) seeds.push_back(worst.seed);
  EXPECT_EQ(seeds, (std::vector<uint64_t>{2, 6, 3, 4, 1}));
  EXPECT_EQ(summary.worst_settled_s.list().front().seed, 7U);
  EXPECT_EQ(summary.worst_settled_s.list().front().arm, 1);
}

TEST(SweepSummary, TheFleetHasSettledWhenItsLastArmHas) {
  ResultTable results(2, {1, 2});
  const SeedResult::Arm quick{1, false, 1.5, 0.7, 2.0, 0.0, std::nullopt};
  const SeedResult::Arm slow{2, false, 4.0, 0.6, 1.0, 0.0, std::nullopt};
  const SeedResult::Arm never{2, false, std::nullopt, 30.0, 50.0, 0.0, std::nullopt};
  results.Set(0, {11, true, 0.65, std::nullopt, {quick, slow}});
  results.Set(1, {12, false, 20.0, std::nullopt, {quick, never}});
  const SweepSummary summary = Summarize(results);
  EXPECT_EQ(summary.fleet_settled_s.count, 1);
  EXPECT_EQ(summary.fleet_settled_s.max, 4.0);
  EXPECT_EQ(summary.worst_settled_s.list().front().arm, 2);
  EXPECT_EQ(summary.fleet_max_mm.max, 50.0);
  EXPECT_EQ(summary.worst_rms_mm.list().front().seed, 12U);
}

TEST(SweepSummary, CountsEveryFailureButListsABoundedNumber) {
  std::vector<SeedResult> runs;
  for (uint64_t seed = 1; seed <= SweepSummary::kFailedSeedsListed + 5; ++seed)
    runs.push_back(ResultOf(seed, 900.0, false));
  const SweepSummary summary = Summarize(SweepOf(runs).results);
  EXPECT_EQ(summary.failed_count(), static_cast<int64_t>(runs.size()));
  EXPECT_EQ(summary.failed_seeds.size(), SweepSummary::kFailedSeedsListed);
  EXPECT_FALSE(summary.fleet_rms_mm.has_value());
  EXPECT_TRUE(summary.worst_rms_mm.list().empty());
}

TEST(SweepSummary, MeasuresAgainstTheFloorsOfTheFleetsThatAreOk) {
  std::vector<SeedResult> runs;
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const bool ok = seed < 10;
    runs.push_back(ResultOf(seed, ok ? 0.5 + 0.001 * static_cast<double>(seed) : 900.0, ok));
    runs.back().floor_rms_mm = runs.back().arms[0].floor_rms_mm = 0.25;
  }
  const SweepSummary summary = Summarize(SweepOf(runs).results);
  ASSERT_TRUE(summary.floor_rms_mm.has_value());
  EXPECT_NEAR(*summary.floor_rms_mm, 0.25, 1e-12);
  EXPECT_EQ(summary.arms[0].floor_mm.count, 9);
  EXPECT_EQ(summary.arms[0].over_floor.count, 9);
  EXPECT_NEAR(summary.arms[0].over_floor.max, 0.509 / 0.25, 1e-12);
  EXPECT_EQ(summary.arms[0].over_floor.worst_seed, 9u);
  EXPECT_EQ(summary.fleet_over_floor.count, 9);
  EXPECT_FALSE(Summarize(SweepOf(1, 9, 1).results).has_floors);
}

TEST(Distribution, PercentilesAreTheNearestRankOfTheSortedFigures) {
  std::mt19937_64 random(5);
  for (const size_t count : {1U, 2U, 19U, 20U, 21U, 1000U, 1001U}) {
    std::vector<double> figures(count);
    for (double& figure : figures) figure = std::exp(static_cast<double>(random() % 4000) / 100.0 - 20.0);
    std::vector<double> sorted = figures;
    std::sort(sorted.begin(), sorted.end());
    const Distribution result = DistributionOf(
        count, [&](size_t row) { return figures[row]; }, [](size_t row) { return row; });
    const auto ranked = [&](size_t per_mille) { return sorted[(per_mille * count + 999) / 1000 - 1]; };
    EXPECT_EQ(result.median, ranked(500)) << count;
    EXPECT_EQ(result.p95, ranked(950)) << count;
    EXPECT_EQ(result.p99, ranked(990)) << count;
    EXPECT_EQ(result.p999, ranked(999)) << count;
    EXPECT_EQ(result.max, sorted.back()) << count;
    EXPECT_EQ(figures[result.worst_seed], sorted.back()) << count;
  }
}

std::map<int, int64_t> BinsOf(const LogHistogram& histogram) {
  const auto json = histogram.ToJson();
  std::map<int, int64_t> bins;
  int bin = json.at("first_bin").get<int>();
  for (const int64_t count : json.at("counts").get<std::vector<int64_t>>()) bins[bin++] = count;
  return bins;
}

TEST(LogHistogram, CountsInBinsOfAHundredthOfADecade) {
  LogHistogram histogram;
  for (const double value : {1.0, 1.02, 1.024, 0.99, 1000.5}) histogram.Add(value);
  const auto bins = BinsOf(histogram);
  EXPECT_EQ(bins.at(0), 2);
  EXPECT_EQ(bins.at(1), 1);
  EXPECT_EQ(bins.at(-1), 1);
  EXPECT_EQ(bins.at(300), 1);
  EXPECT_EQ(bins.size(), 302U);
}

TEST(LogHistogram, WhatIsBeyondItsBinsIsInTheOutermost) {
  LogHistogram histogram;
  for (const double value : {0.0, 1e-30, 1e30, HUGE_VAL}) histogram.Add(value);
  const auto bins = BinsOf(histogram);
  EXPECT_EQ(bins.begin()->second, 2);
  EXPECT_EQ(bins.rbegin()->first, 899);
  EXPECT_EQ(bins.rbegin()->second, 2);
  EXPECT_TRUE(BinsOf(LogHistogram()).empty());
}

TEST(LogHistogram, OfAWholeIsTheSumOfItsParts) {
  std::mt19937_64 random(6);
  LogHistogram whole;
  LogHistogram parts[3];
  for (int i = 0; i < 3000; ++i) {
    const double value = 0.5 + static_cast<double>(random() % 1000) / 500.0;
    whole.Add(value);
    parts[i % 3].Add(value);
  }
  std::map<int, int64_t> sum;
  for (const LogHistogram& part : parts) {
    for (const auto& [bin, count] : BinsOf(part)) sum[bin] += count;
  }
  EXPECT_EQ(sum, BinsOf(whole));
}

TEST(SeedRange, ShardsPartTheSeedsAmongThem) {
  const auto all = ParseSeeds("3:20");
  ASSERT_TRUE(all.has_value());
  EXPECT_EQ(all->size(), 18U);
  std::vector<int> taken(21, 0);
  for (const char* shard : {"1/4", "2/4", "3/4", "4/4"}) {
    const auto seeds = ShardOf(*all, shard);
    ASSERT_TRUE(seeds.has_value()) << shard;
    for (size_t i = 0; i < seeds->size(); ++i) ++taken[(*seeds)[i]];
  }
  for (size_t seed = 3; seed <= 20; ++seed) EXPECT_EQ(taken[seed], 1) << seed;
  EXPECT_EQ(ShardOf(*all, "19/20")->size(), 0U);
}

TEST(SeedRange, RefusesWhatIsNone) {
  for (const char* text : {"", "5", "5:", ":5", "9:1", "1:2:3", "1-2", "a:b", "-1:2"})
    EXPECT_FALSE(ParseSeeds(text).has_value()) << text;
  for (const char* text : {"", "1", "0/2", "3/2", "1/0", "1:2", "1/2/3"})
    EXPECT_FALSE(ShardOf({1, 10, 1}, text).has_value()) << text;
}

}  // namespace
}  // namespace armada
