#include "host/sweep/sweep_command.h"

#include <cstdio>
#include <fstream>
#include <iostream>

#include "firmware/app/exit_codes.h"
#include "host/floor/floor_command.h"
#include "host/sim/simulation.h"
#include "host/sweep/seed_jobs.h"
#include "host/sweep/sweep_result.h"

namespace armada {
namespace {

int Usage(const std::string& message) {
  std::cerr << "armada sweep: " << message << '\n';
  return kExitUsage;
}

std::string Fixed(double value, int decimals) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

void PrintSummary(const SweepSummary& summary) {
  std::printf(
      "arm  diverged  unsettled  rms_mm: median      95%%    99.9%%  settled_s: median      95%%      max  "
      "worst seed%s\n",
      summary.has_floors ? "  floor_mm: median  ratio: median      95%" : "");
  for (const SweepArmSummary& arm : summary.arms) {
    std::printf("%3d  %8lld  %9lld  %14.3f  %7.3f  %7.3f  %17.2f  %7.2f  %7.2f  %10llu", arm.id,
                static_cast<long long>(arm.diverged), static_cast<long long>(arm.never_settled),
                arm.rms_mm.median, arm.rms_mm.p95, arm.rms_mm.p999, arm.settled_s.median, arm.settled_s.p95,
                arm.settled_s.max, static_cast<unsigned long long>(arm.rms_mm.worst_seed));
    if (summary.has_floors)
      std::printf("  %16.3f  %13.2f  %7.2f", arm.floor_mm.median, arm.over_floor.median, arm.over_floor.p95);
    std::printf("\n");
  }
  std::printf("fleet RMS of all: median %.3f mm, 95%% %.3f mm, max %.3f mm (seed %llu)\n",
              summary.fleet_rms_all_mm.median, summary.fleet_rms_all_mm.p95, summary.fleet_rms_all_mm.max,
              static_cast<unsigned long long>(summary.fleet_rms_all_mm.worst_seed));
  std::string fleet_rms;
  if (summary.fleet_rms_mm) fleet_rms = ", their RMS " + Fixed(*summary.fleet_rms_mm, 3) + " mm";
  if (summary.floor_rms_mm) {
    fleet_rms += ", " + Fixed(*summary.fleet_rms_mm / *summary.floor_rms_mm, 2) + " times their floor of " +
                 Fixed(*summary.floor_rms_mm, 3) + " mm";
  }
  std::printf("%lld of %lld fleets ok%s, estimator RMS %.3g mm\n", static_cast<long long>(summary.ok_count),
              static_cast<long long>(summary.count), fleet_rms.c_str(), summary.estimator_rms_x_m * 1e3);
  if (!summary.failed_seeds.empty()) {
    std::printf("not ok:");
    for (size_t i = 0; i < summary.failed_seeds.size() && i < 10; ++i) {
      std::printf(" %llu", static_cast<unsigned long long>(summary.failed_seeds[i]));
    }
    std::printf("%s\n", summary.failed_seeds.size() > 10 ? " .." : "");
  }
}

int Finish(const Sweep& sweep, const std::string& json) {
  const SweepSummary summary = Summarize(sweep.runs);
  PrintSummary(summary);
  std::string error;
  if (!json.empty() && !WriteJson(ToJson(sweep), json, &error)) {
    std::cerr << "armada sweep: " << error << '\n';
    return kExitFailed;
  }
  return summary.ok_count == summary.count ? kExitOk : kExitFailed;
}

}  // namespace

int RunSweepCommand(const SweepOptions& options) {
  uint64_t first = 0, last = 0, shard = 0, shards = 0;
  if (!ParseSeeds(options.seeds, &first, &last)) {
    return Usage("--seeds " + options.seeds + ": allowed is A:B with A <= B");
  }
  if (!ParsePair(options.shard, '/', &shard, &shards) || shard < 1 || shard > shards) {
    return Usage("--shard " + options.shard + ": allowed is I/N with 1 <= I <= N");
  }
  const auto scenario = options.scenario.Load();
  if (!scenario) return kExitBadConfig;
  if (options.floor && !HasFloor(*scenario)) return kExitUsage;
  std::vector<uint64_t> seeds;
  for (uint64_t seed = first + shard - 1; seed <= last; seed += shards) seeds.push_back(seed);
  std::vector<SeedResult> results(seeds.size());
  RunSeedJobs(seeds, options.jobs, [&](size_t index, uint64_t seed) {
    RunMetrics metrics = Simulation(*scenario, seed).Run(nullptr);
    if (options.floor) metrics.CompareWithFloor(*scenario);
    results[index] = SeedResult::Of(metrics);
    return results[index].ok;
  });
  return Finish({scenario->name, options.scenario.Overrides(), std::move(results)}, options.json);
}

int RunSweepMergeCommand(const std::vector<std::string>& files, const std::string& json) {
  std::vector<Sweep> shards;
  for (const std::string& path : files) {
    std::ifstream file(path);
    if (!file) return Usage("cannot read " + path);
    std::string error;
    const auto parsed = nlohmann::ordered_json::parse(file, nullptr, false);
    const auto shard =
        parsed.is_discarded() ? (error = "not JSON", std::nullopt) : SweepFromJson(parsed, &error);
    if (!shard) return Usage(std::string(path).append(": ").append(error));
    shards.push_back(*shard);
  }
  std::string error;
  const auto merged = Merge(shards, &error);
  if (!merged) return Usage(error);
  return Finish(*merged, json);
}

}  // namespace armada
