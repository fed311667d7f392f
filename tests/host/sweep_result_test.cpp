#include "host/sweep/sweep_result.h"

#include <gtest/gtest.h>

namespace armada {
namespace {

SeedResult ResultOf(uint64_t seed, double rms_mm, bool ok) {
  SeedResult result{.seed = seed, .ok = ok, .fleet_rms_mm = rms_mm, .floor_rms_mm = std::nullopt, .arms = {}};
  result.arms.push_back({.id = 1,
                         .diverged = !ok,
                         .settled_s = std::nullopt,
                         .rms_mm = rms_mm,
                         .max_mm = 3.0 * rms_mm,
                         .estimator_x_m = 1e-5,
                         .floor_rms_mm = std::nullopt});
  if (ok) result.arms[0].settled_s = 0.1 * static_cast<double>(seed);
  return result;
}

Sweep SweepOf(uint64_t first, uint64_t last, uint64_t step) {
  Sweep sweep{"paper", {}, {}};
  for (uint64_t seed = first; seed <= last; seed += step)
    sweep.runs.push_back(ResultOf(seed, 0.5 + 0.001 * static_cast<double>(seed), true));
  return sweep;
}

TEST(Sweep, ShardsMergeToTheWholeByteForByte) {
  std::string error;
  const auto merged = Merge({SweepOf(3, 100, 3), SweepOf(1, 100, 3), SweepOf(2, 100, 3)}, &error);
  ASSERT_TRUE(merged.has_value()) << error;
  EXPECT_EQ(ToJson(*merged).dump(), ToJson(SweepOf(1, 100, 1)).dump());
}

TEST(Sweep, ReadsBackWhatItWrote) {
  const Sweep sweep = SweepOf(1, 20, 1);
  std::string error;
  const auto read = SweepFromJson(ToJson(sweep), &error);
  ASSERT_TRUE(read.has_value()) << error;
  EXPECT_EQ(ToJson(*read).dump(), ToJson(sweep).dump());
}

Sweep WithFloors(Sweep sweep, double floor_mm) {
  for (SeedResult& run : sweep.runs) {
    run.floor_rms_mm = floor_mm;
    run.arms[0].floor_rms_mm = floor_mm;
  }
  return sweep;
}

TEST(Sweep, WithFloorsMergesToTheWholeByteForByte) {
  std::string error;
  const auto first = SweepFromJson(ToJson(WithFloors(SweepOf(1, 10, 2), 0.4)), &error);
  const auto second = SweepFromJson(ToJson(WithFloors(SweepOf(2, 10, 2), 0.4)), &error);
  ASSERT_TRUE(first.has_value() && second.has_value()) << error;
  const Sweep without_seeds{"paper", {}, {}};
  const auto merged = Merge({without_seeds, *first, *second}, &error);
  ASSERT_TRUE(merged.has_value()) << error;
  EXPECT_EQ(ToJson(*merged).dump(), ToJson(WithFloors(SweepOf(1, 10, 1), 0.4)).dump());
  EXPECT_FALSE(Merge({*first, SweepOf(2, 10, 2)}, &error).has_value());
  EXPECT_EQ(error, "some of the files have floors, some do not");
}

TEST(Sweep, SummaryMeasuresAgainstTheFloorsOfTheFleetsThatAreOk) {
  Sweep sweep = SweepOf(1, 9, 1);
  sweep.runs.push_back(ResultOf(10, 900.0, false));
  const SweepSummary summary = Summarize(WithFloors(sweep, 0.25).runs);
  ASSERT_TRUE(summary.floor_rms_mm.has_value());
  EXPECT_NEAR(*summary.floor_rms_mm, 0.25, 1e-12);
  EXPECT_EQ(summary.arms[0].over_floor.count, 9);
  EXPECT_NEAR(summary.arms[0].over_floor.max, 0.509 / 0.25, 1e-12);
  EXPECT_EQ(summary.arms[0].over_floor.worst_seed, 9u);
  const auto json = ToJson(WithFloors(sweep, 0.25));
  EXPECT_NEAR(json.at("over_floor").get<double>(), *summary.fleet_rms_mm / 0.25, 1e-12);
  EXPECT_FALSE(ToJson(sweep).contains("floor_rms_mm")) << "without --floor there is none";
}

TEST(Sweep, RefusesASeedThatIsInTwoShards) {
  std::string error;
  EXPECT_FALSE(Merge({SweepOf(1, 10, 1), SweepOf(10, 20, 1)}, &error).has_value());
  EXPECT_EQ(error, "seed 10 is in two of the files");
}

TEST(Sweep, RefusesShardsOfDifferentSettings) {
  Sweep other = SweepOf(11, 20, 1);
  other.overrides = {"control.law=paper"};
  std::string error;
  EXPECT_FALSE(Merge({SweepOf(1, 10, 1), other}, &error).has_value());
}

TEST(Sweep, RefusesWhatIsNoSweep) {
  std::string error;
  EXPECT_FALSE(SweepFromJson({{"schema", 1}, {"mode", "sim"}}, &error).has_value());
  EXPECT_FALSE(SweepFromJson({{"schema", 1}, {"mode", "sweep"}}, &error).has_value());
}

TEST(Sweep, SummaryCountsFailuresAndNamesTheWorstSeed) {
  std::vector<SeedResult> runs = SweepOf(1, 99, 1).runs;
  runs.push_back(ResultOf(100, 900.0, false));
  const SweepSummary summary = Summarize(runs);
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

}  // namespace
}  // namespace armada
