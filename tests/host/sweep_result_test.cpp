#include "host/sweep/sweep_result.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "tests/host/sweep_samples.h"

namespace armada {
namespace {

/// A file of this test's own.
std::string PathOf(const std::string& name) {
  return testing::TempDir() + "/armada_sweep_" +
         testing::UnitTest::GetInstance()->current_test_info()->name() + "_" + name;
}

std::string Written(const Sweep& sweep, const std::string& name) {
  const std::string path = PathOf(name);
  std::string error;
  EXPECT_TRUE(WriteSweep(sweep, Summarize(sweep.results), path, &error)) << error;
  return path;
}

std::string Bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::vector<Sweep> Read(const std::vector<std::string>& paths) {
  std::vector<Sweep> sweeps;
  for (const std::string& path : paths) {
    std::string error;
    auto sweep = ReadSweep(path, &error);
    EXPECT_TRUE(sweep.has_value()) << error;
    sweeps.push_back(std::move(*sweep));
  }
  return sweeps;
}

std::string ErrorOf(const std::string& text) {
  const std::string path = PathOf("wrong.json");
  std::ofstream(path) << text;
  std::string error;
  EXPECT_FALSE(ReadSweep(path, &error).has_value());
  EXPECT_EQ(error.rfind(path + ": ", 0), 0U) << error;
  return error;
}

TEST(Sweep, ShardsMergeToTheWholeByteForByte) {
  // The third shard of more than there are seeds is empty.
  const std::vector<Sweep> shards =
      Read({Written(SweepOf(3, 100, 3), "3"), Written(SweepOf(1, 100, 3), "1"),
            Written(SweepOf(2, 100, 3), "2"), Written(SweepOf(9, 8, 1), "none")});
  std::string error;
  const auto merged = Merge(shards, &error);
  ASSERT_TRUE(merged.has_value()) << error;
  EXPECT_EQ(Bytes(Written(*merged, "merged")), Bytes(Written(SweepOf(1, 100, 1), "whole")));
}

Sweep WithFloors(const Sweep& sweep, double floor_mm) {
  std::vector<SeedResult> results;
  for (size_t row = 0; row < sweep.results.rows(); ++row) {
    results.push_back(sweep.results.At(row));
    results.back().floor_rms_mm = results.back().arms[0].floor_rms_mm = floor_mm;
  }
  return SweepOf(results);
}

TEST(Sweep, WithFloorsMergesToTheWholeByteForByte) {
  const std::vector<Sweep> shards =
      Read({Written(WithFloors(SweepOf(1, 10, 2), 0.4), "1"),
            Written(WithFloors(SweepOf(2, 10, 2), 0.4), "2"), Written(SweepOf(12, 12, 1), "without")});
  std::string error;
  const auto merged = Merge(Read({Written(SweepOf(9, 8, 1), "none"), PathOf("1"), PathOf("2")}), &error);
  ASSERT_TRUE(merged.has_value()) << error;
  const std::string whole = Bytes(Written(WithFloors(SweepOf(1, 10, 1), 0.4), "whole"));
  EXPECT_EQ(Bytes(Written(*merged, "merged")), whole);
  EXPECT_NE(whole.find("\"over_floor\": "), std::string::npos);
  EXPECT_EQ(Bytes(PathOf("without")).find("floor"), std::string::npos) << "without --floor there is none";
  EXPECT_FALSE(Merge(shards, &error).has_value());
  EXPECT_EQ(error, "some of the files have floors, some do not");
}

TEST(Sweep, ReadsBackWhatItWrote) {
  std::vector<SeedResult> results;
  for (uint64_t seed = 1; seed <= 20; ++seed)
    results.push_back(ResultOf(seed, 0.1 + 1.0 / static_cast<double>(seed), seed % 7 != 0));
  Sweep sweep = SweepOf(results);
  sweep.overrides = {"control.law=paper"};
  const std::string path = Written(sweep, "first");
  EXPECT_EQ(Bytes(Written(Read({path}).front(), "again")), Bytes(path));
}

TEST(Sweep, IsPlainJsonWithALineForEverySeed) {
  const std::string text = Bytes(Written(SweepOf(5, 30, 5), "json"));
  const auto json = nlohmann::json::parse(text);
  EXPECT_EQ(json.at("runs").size(), 6U);
  EXPECT_EQ(json.at("first_seed"), 5);
  EXPECT_EQ(json.at("last_seed"), 30);
  EXPECT_EQ(json.at("arms").at(0).at("settled_s").at("p99"), 3.0);
  for (const auto& run : json.at("runs"))
    EXPECT_NE(text.find("\n    {\"seed\":" + run.at("seed").dump() + ","), std::string::npos);
}

TEST(Sweep, NamesTheCommandThatReplaysItsWorstSeed) {
  Sweep sweep = SweepOf(1, 20, 1);
  sweep.scenario_file = "my scenarios/paper.toml";
  sweep.overrides = {"control.law=paper", "arm.*.drive=\"damiao\""};
  const auto header = HeaderJson(sweep, Summarize(sweep.results));
  const std::string command =
      "armada sim 'my scenarios/paper.toml' --set control.law=paper --set 'arm.*.drive=\"damiao\"' --seed";
  EXPECT_EQ(header.at("replay"), command);
  EXPECT_EQ(header.at("worst").at("settled_s").at(0).at("command"), command + " 20");
}

TEST(Sweep, RefusesASeedThatIsInTwoShards) {
  std::string error;
  EXPECT_FALSE(
      Merge(Read({Written(SweepOf(1, 10, 1), "a"), Written(SweepOf(10, 20, 1), "b")}), &error).has_value());
  EXPECT_EQ(error, "seed 10 is in two of the files");
}

TEST(Sweep, RefusesShardsOfDifferentSettings) {
  Sweep other = SweepOf(11, 20, 1);
  other.overrides = {"control.law=paper"};
  std::string error;
  EXPECT_FALSE(Merge(Read({Written(SweepOf(1, 10, 1), "a"), Written(other, "b")}), &error).has_value());
  EXPECT_NE(error.find("different scenarios or settings"), std::string::npos) << error;
}

TEST(Sweep, RefusesWhatIsNoSweep) {
  EXPECT_NE(ErrorOf("{\"schema\": 1").find("parse error"), std::string::npos);
  EXPECT_NE(ErrorOf("{\"schema\": 1, \"mode\": \"sim\"}").find("not a sweep"), std::string::npos);
  EXPECT_NE(ErrorOf("{\"schema\": 1, \"mode\": \"sweep\"}").find("runs"), std::string::npos);
  EXPECT_NE(ErrorOf("[1, 2]").find("json.exception"), std::string::npos);
  const std::string text = Bytes(Written(SweepOf(1, 2, 1), "good"));
  std::string swapped = text;
  swapped.replace(text.find("{\"seed\":1,\"ok\""), 9, "{\"seed\":9");
  EXPECT_NE(ErrorOf(swapped).find("seed 2 stands after"), std::string::npos);
  std::string error;
  EXPECT_FALSE(ReadSweep("/nowhere/sweep.json", &error).has_value());
  EXPECT_EQ(error, "/nowhere/sweep.json: cannot be read");
}

TEST(Sweep, SaysWhenItCannotBeWritten) {
  const Sweep sweep = SweepOf(1, 2, 1);
  std::string error;
  EXPECT_FALSE(WriteSweep(sweep, Summarize(sweep.results), "/proc/no/sweep.json", &error));
  EXPECT_NE(error.find("/proc/no/sweep.json"), std::string::npos) << error;
}

}  // namespace
}  // namespace armada
