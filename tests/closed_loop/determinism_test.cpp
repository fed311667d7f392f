#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "tests/closed_loop/simulate.h"

namespace armada {
namespace {

std::string Bytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

struct TracedRun {
  std::string metrics;
  std::vector<std::string> files;
};

TracedRun RunTraced(uint64_t seed) {
  const std::string directory = testing::TempDir() + "/armada_determinism_" +
                                testing::UnitTest::GetInstance()->current_test_info()->name();
  std::filesystem::remove_all(directory);
  const ScenarioConfig scenario = ScenarioNamed(
      "paper", {"seconds=3.0", "window_start_s=1.0", "network.loss=0.1", "drive.velocity_noise_rad_s=0.01"});
  TraceWriter trace(directory, scenario.fleet);
  EXPECT_TRUE(trace.ok()) << trace.error();
  TracedRun run{ToJson(Simulation(scenario, seed).Run(&trace)).dump(), {}};
  EXPECT_TRUE(trace.Close());
  for (const ArmEntry& arm : scenario.fleet.arms) {
    run.files.push_back(Bytes(directory + "/arm_" + std::to_string(arm.id) + ".csv"));
  }
  std::filesystem::remove_all(directory);
  return run;
}

TEST(Determinism, TheSameSeedGivesTheSameBytes) {
  const TracedRun first = RunTraced(7);
  const TracedRun second = RunTraced(7);
  EXPECT_EQ(first.metrics, second.metrics);
  EXPECT_EQ(first.files, second.files);
  EXPECT_GT(first.files.front().size(), 10'000u);
}

TEST(Determinism, AnotherSeedGivesAnotherRun) {
  EXPECT_NE(RunTraced(7).files, RunTraced(8).files);
}

}  // namespace
}  // namespace armada
