#include "host/sweep/sweep_command.h"

#include <iostream>
#include <system_error>

#include "firmware/app/exit_codes.h"
#include "firmware/app/whole_file.h"
#include "host/floor/floor_command.h"
#include "host/sim/simulation.h"
#include "host/sweep/seed_jobs.h"
#include "host/sweep/sweep_result.h"
#include "host/sweep/sweep_text.h"

namespace armada {
namespace {

int Usage(const std::string& message) {
  std::cerr << "armada sweep: " << message << '\n';
  return kExitUsage;
}

int Failed(const std::string& message) {
  std::cerr << "armada sweep: " << message << '\n';
  return kExitFailed;
}

int Finish(const Sweep& sweep, const std::string& json) {
  const SweepSummary summary = Summarize(sweep.results);
  PrintSweep(sweep, summary, std::cout);
  std::string error;
  if (!json.empty() && !WriteSweep(sweep, summary, json, &error)) return Failed(error);
  return summary.ok_count == summary.count ? kExitOk : kExitFailed;
}

}  // namespace

int RunSweepCommand(const SweepOptions& options) {
  const auto all = ParseSeeds(options.seeds);
  if (!all) return Usage("--seeds " + options.seeds + ": allowed is A:B with A <= B");
  const auto seeds = ShardOf(*all, options.shard);
  if (!seeds) return Usage("--shard " + options.shard + ": allowed is I/N with 1 <= I <= N");
  const auto scenario = options.scenario.Load();
  if (!scenario) return kExitBadConfig;
  if (options.floor && !HasFloor(*scenario)) return kExitUsage;
  if (std::string error; !options.json.empty() && !CanWriteWhole(options.json, &error)) return Failed(error);
  try {
    ResultTable results(seeds->size(), ArmIds(*scenario));
    RunSeedJobs(*seeds, options.jobs, [&](size_t row, uint64_t seed) {
      RunMetrics metrics = Simulation(*scenario, seed).Run(nullptr);
      if (options.floor) metrics.CompareWithFloor(*scenario);
      results.Set(row, SeedResult::Of(metrics));
      return metrics.ok;
    });
    return Finish({scenario->name, scenario->file, options.scenario.Overrides(), std::move(results)},
                  options.json);
  } catch (const std::system_error& error) {
    return Failed(error.what());
  }
}

int RunSweepMergeCommand(const std::vector<std::string>& files, const std::string& json) {
  std::vector<Sweep> shards;
  std::string error;
  for (const std::string& path : files) {
    auto shard = ReadSweep(path, &error);
    if (!shard) return Usage(error);
    shards.push_back(std::move(*shard));
  }
  try {
    const auto merged = Merge(shards, &error);
    if (!merged) return Usage(error);
    return Finish(*merged, json);
  } catch (const std::system_error& problem) {
    return Failed(problem.what());
  }
}

}  // namespace armada
