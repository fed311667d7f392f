// What a run has learnt is the start of the next one: `learned` in the folder of a run, start.learned.

#include <filesystem>

#include "tests/closed_loop/simulate.h"

namespace armada {
namespace {

// While a cold start still learns.
const std::vector<std::string> kFirstSecond = {"seconds=0.8", "window_start_s=0.3"};

double WorstFleetRms(const std::vector<std::string>& sets) {
  double worst_m = 0.0;
  for (uint64_t seed = 2; seed <= 21; ++seed)
    worst_m = std::max(worst_m, Simulate("benign", seed, sets).fleet_rms_m);
  return worst_m;
}

TEST(WarmStart, SparesTheErrorsOfLearning) {
  const std::string folder = testing::TempDir() + "armada_warm_start";
  Simulation first(ScenarioNamed("paper", {"seconds=10.0", "window_start_s=5.0"}), 1);
  first.Run(nullptr);
  std::string error;
  ASSERT_TRUE(first.WriteLearned(folder, &error)) << error;
  std::vector<std::string> warm = kFirstSecond;
  warm.push_back("start.learned=" + folder);
  EXPECT_LT(WorstFleetRms(warm), 0.9 * WorstFleetRms(kFirstSecond));
  const RunMetrics again = Simulate("benign", 2, {"seconds=0.1", "window_start_s=0.05", warm.back()});
  for (const ArmMetrics& arm : again.arms) EXPECT_LT(arm.parameter_error, 0.15) << "arm " << arm.id;
  std::filesystem::remove_all(folder);
}

TEST(WarmStart, FromAFolderWithoutFilesIsRefused) {
  std::vector<ConfigError> errors;
  EXPECT_FALSE(LoadScenario(std::string(ARMADA_SOURCE_DIR) + "/hil/scenarios/paper.toml",
                            {"start.learned=/nonexistent"}, &errors)
                   .has_value());
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].key, "start.learned");
}

}  // namespace
}  // namespace armada
