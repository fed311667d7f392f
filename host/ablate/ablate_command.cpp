#include "host/ablate/ablate_command.h"

#include <iostream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "firmware/app/exit_codes.h"
#include "firmware/app/whole_file.h"
#include "hil/scenario_file.h"
#include "host/ablate/ablation.h"
#include "host/sim/simulation.h"
#include "host/sweep/seed_jobs.h"

namespace armada {
namespace {

// The scenarios that can be run, the whole one first, and a result for each row that cannot.
struct Prepared {
  std::vector<ScenarioConfig> scenarios;
  std::vector<const AblationRow*> rows;  ///< by scenario
  std::vector<AblationResult> refused;
};

Prepared Prepare(const ScenarioConfig& whole, const ScenarioArguments& arguments) {
  Prepared prepared{{whole}, {nullptr}, {}};
  for (const AblationRow& row : AblationRows()) {
    std::vector<std::string> overrides = arguments.Overrides();
    overrides.insert(overrides.end(), row.overrides.begin(), row.overrides.end());
    std::vector<ConfigError> errors;
    if (auto scenario = LoadScenario(arguments.scenario, overrides, &errors)) {
      prepared.scenarios.push_back(std::move(*scenario));
      prepared.rows.push_back(&row);
    } else {
      prepared.refused.push_back({&row, ToString(errors.front()), {}, 0.0, std::nullopt});
    }
  }
  return prepared;
}

}  // namespace

int RunAblateCommand(const AblateOptions& options) {
  const auto seeds = ParseSeeds(options.seeds);
  if (!seeds) {
    std::cerr << "armada ablate: --seeds " << options.seeds << ": allowed is A:B with A <= B\n";
    return kExitUsage;
  }
  const auto whole = options.scenario.Load();
  if (!whole) return kExitBadConfig;
  std::string error;
  if (!options.json.empty() && !CanWriteWhole(options.json, &error)) {
    std::cerr << "armada ablate: " << error << '\n';
    return kExitFailed;
  }
  const Prepared prepared = Prepare(*whole, options.scenario);
  Ablation ablation{whole->name, whole->file, options.scenario.Overrides(), *seeds, {}};
  try {
    std::vector<ResultTable> tables;
    for (const ScenarioConfig& scenario : prepared.scenarios) {
      ResultTable& table = tables.emplace_back(seeds->size(), ArmIds(scenario));
      RunSeedJobs(*seeds, options.jobs, [&](size_t row, uint64_t seed) {
        const SeedResult result = SeedResult::Of(Simulation(scenario, seed).Run(nullptr));
        table.Set(row, result);
        return result.ok;
      });
      ablation.rows.push_back(Compare(prepared.rows[ablation.rows.size()], table, tables.front()));
    }
  } catch (const std::system_error& problem) {
    std::cerr << "armada ablate: " << problem.what() << '\n';
    return kExitFailed;
  }
  ablation.rows.insert(ablation.rows.end(), prepared.refused.begin(), prepared.refused.end());
  PrintAblation(ablation, std::cout);
  if (!options.json.empty() && !WriteJson(ToJson(ablation), options.json, &error)) {
    std::cerr << "armada ablate: " << error << '\n';
    return kExitFailed;
  }
  const SweepSummary& summary = ablation.rows.front().summary;
  return summary.ok_count == summary.count ? kExitOk : kExitFailed;
}

}  // namespace armada
