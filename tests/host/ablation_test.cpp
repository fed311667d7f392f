#include "host/ablate/ablation.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "hil/scenario_file.h"
#include "host/sim/simulation.h"
#include "tests/host/sweep_samples.h"

namespace armada {
namespace {

ScenarioConfig PaperWith(std::vector<std::string> overrides) {
  overrides.insert(overrides.end(), {"seconds=3.0", "window_start_s=0.0"});
  std::vector<ConfigError> errors;
  auto scenario =
      LoadScenario(std::string(ARMADA_SOURCE_DIR) + "/hil/scenarios/paper.toml", overrides, &errors);
  for (const ConfigError& error : errors) ADD_FAILURE() << ToString(error);
  return scenario.value();
}

// Keys that no longer exist, values out of range and switches that switch nothing show here.
TEST(AblationRows, EachIsPossibleAndChangesThePaperScenario) {
  const auto figures = [](const std::vector<std::string>& overrides) {
    // Without its law's and estimator's names, which would differ by themselves.
    return ToJson(Simulation(PaperWith(overrides), 2).Run(nullptr)).at("arms").dump();
  };
  const std::string whole = figures({});
  for (const AblationRow& row : AblationRows())
    EXPECT_NE(figures({row.overrides.begin(), row.overrides.end()}), whole) << row.component;
}

const AblationRow kRow{"governor", "holds back", {"some.key=1.0"}};

TEST(Ablation, ComparesOverTheSeedsInWhichBothAreOk) {
  const Sweep whole = SweepOf({ResultOf(1, 1.0, true), ResultOf(2, 1.0, true), ResultOf(3, 1.0, true)});
  const Sweep without = SweepOf({ResultOf(1, 2.0, true), ResultOf(2, 2.0, true), ResultOf(3, 900.0, false)});
  const AblationResult with = Compare(nullptr, whole.results, whole.results);
  const AblationResult result = Compare(&kRow, without.results, whole.results);
  EXPECT_DOUBLE_EQ(with.ratio.value(), 1.0);
  EXPECT_DOUBLE_EQ(result.ratio.value(), 2.0);
  EXPECT_DOUBLE_EQ(result.diverged_share, 1.0 / 3.0);
  EXPECT_EQ(Earnings(with, result), "33.3 % of the fleets, RMS 2 times smaller");
}

TEST(Ablation, SaysWhenAComponentEarnsNothingOrCosts) {
  const Sweep whole = SweepOf({ResultOf(1, 1.0, true), ResultOf(2, 1.0, true)});
  const Sweep alike = SweepOf({ResultOf(1, 1.001, true), ResultOf(2, 1.0, true)});
  const Sweep better = SweepOf({ResultOf(1, 0.8, true), ResultOf(2, 0.8, true)});
  const AblationResult with = Compare(nullptr, whole.results, whole.results);
  const Sweep slower = SweepOf({ResultOf(10, 1.0, true), ResultOf(20, 1.0, true)});
  EXPECT_EQ(Earnings(with, Compare(&kRow, slower.results, whole.results)),
            "median settling 0.1 s instead of 1 s, worst settling 0.2 s instead of 2 s");
  EXPECT_EQ(Earnings(with, Compare(&kRow, alike.results, whole.results)), "nothing here");
  EXPECT_EQ(Earnings(with, Compare(&kRow, better.results, whole.results)), "RMS 1.25 times larger");
}

TEST(Ablation, PrintsAndWritesEveryRowTheRefusedOnesToo) {
  const Sweep whole = SweepOf(1, 4, 1);
  const Sweep none = SweepOf({ResultOf(1, 900.0, false), ResultOf(2, 900.0, false), ResultOf(3, 900.0, false),
                              ResultOf(4, 900.0, false)});
  Ablation ablation{"paper", "paper.toml", {"seconds=3.0"}, {1, 4, 1}, {}};
  ablation.rows.push_back(Compare(nullptr, whole.results, whole.results));
  ablation.rows.push_back(Compare(&kRow, none.results, whole.results));
  ablation.rows.push_back({&kRow, "some.key is no key", {}, 0.0, std::nullopt});
  std::ostringstream text;
  PrintAblation(ablation, text);
  for (const char* part :
       {"(nothing)  100.00        0.00", "governor     0.00      100.00                  -       -",
        "not possible here: some.key is no key", "holds back: 100 % of the fleets"})
    EXPECT_NE(text.str().find(part), std::string::npos) << part << " is not in\n" << text.str();

  const auto json = ToJson(ablation);
  EXPECT_EQ(json.at("mode"), "ablation");
  ASSERT_EQ(json.at("rows").size(), 3U);
  EXPECT_TRUE(json.at("rows").at(0).at("without").is_null());
  EXPECT_EQ(json.at("rows").at(0).at("ok_count"), 4);
  EXPECT_EQ(json.at("rows").at(1).at("without"), "governor");
  EXPECT_TRUE(json.at("rows").at(1).at("ratio").is_null());
  EXPECT_EQ(json.at("rows").at(1).at("earns"), "100 % of the fleets");
  EXPECT_EQ(json.at("rows").at(2).at("refused"), "some.key is no key");
}

}  // namespace
}  // namespace armada
