#include "host/floor/floor_command.h"

#include <cstdio>
#include <iostream>

#include "firmware/app/exit_codes.h"
#include "firmware/app/whole_file.h"
#include "host/floor/floor.h"
#include "host/json.h"
#include "host/metrics.h"
#include "host/sweep/seed_jobs.h"

namespace armada {
namespace {

struct FloorSweep {
  SeedRange seeds;
  std::vector<FloorResult> floors;  ///< one a seed
};

Json ToJson(const std::vector<ArmFloor>& arms) {
  Json json = Json::array();
  for (const ArmFloor& arm : arms) {
    json.push_back(
        {{"id", arm.id}, {"dof", arm.dof}, {"rms_mm", arm.rms_m * 1e3}, {"max_mm", arm.max_m * 1e3}});
  }
  return json;
}

Json ToJson(const ScenarioConfig& scenario, const std::vector<std::string>& overrides,
            const FloorSweep& sweep) {
  const FloorResult together = Together(sweep.floors);
  Json runs = Json::array();
  for (size_t i = 0; i < sweep.seeds.size(); ++i) {
    const FloorResult& floor = sweep.floors[i];
    runs.push_back(
        {{"seed", sweep.seeds[i]}, {"fleet_rms_mm", floor.fleet_rms_m * 1e3}, {"arms", ToJson(floor.arms)}});
  }
  return {{"schema", 1},
          {"mode", "floor"},
          {"scenario", scenario.name},
          {"set", overrides},
          {"window_s", {scenario.window_start_s, scenario.seconds}},
          {"count", sweep.seeds.size()},
          {"fleet_rms_mm", together.fleet_rms_m * 1e3},
          {"arms", ToJson(together.arms)},
          {"runs", runs}};
}

void Print(const ScenarioConfig& scenario, const FloorSweep& sweep) {
  const FloorResult together = Together(sweep.floors);
  std::printf("arm  joints  floor_mm   max_mm\n");
  for (const ArmFloor& arm : together.arms) {
    std::printf("%3d  %6d  %8.3f  %7.3f\n", arm.id, arm.dof, arm.rms_m * 1e3, arm.max_m * 1e3);
  }
  std::printf("floor: fleet RMS %.3f mm over %g-%g s, ", together.fleet_rms_m * 1e3, scenario.window_start_s,
              scenario.seconds);
  std::printf(sweep.seeds.size() == 1 ? "seed %llu\n" : "seeds %llu to %llu\n",
              static_cast<unsigned long long>(sweep.seeds.first),
              static_cast<unsigned long long>(sweep.seeds.last));
}

}  // namespace

bool HasFloor(const ScenarioConfig& scenario) {
  if (scenario.leader.kind != LeaderKind::kNone) return true;
  std::cerr << "armada: " << scenario.file
            << " has no leader: there is nothing to measure an error against\n";
  return false;
}

int RunFloorCommand(const FloorOptions& options) {
  const auto seeds =
      options.seeds.empty() ? SeedRange{options.seed, options.seed, 1} : ParseSeeds(options.seeds);
  if (!seeds) {
    std::cerr << "armada floor: --seeds " << options.seeds << ": allowed is A:B with A <= B\n";
    return kExitUsage;
  }
  const auto scenario = options.scenario.Load();
  if (!scenario) return kExitBadConfig;
  if (!HasFloor(*scenario)) return kExitUsage;
  std::string error;
  if (!options.json.empty() && !CanWriteWhole(options.json, &error)) {
    std::cerr << "armada floor: " << error << '\n';
    return kExitFailed;
  }
  FloorSweep sweep{*seeds, std::vector<FloorResult>(seeds->size())};
  RunSeedJobs(sweep.seeds, options.jobs, [&](size_t index, uint64_t seed) {
    sweep.floors[index] = Floor(*scenario, seed);
    return true;
  });
  Print(*scenario, sweep);
  if (!options.json.empty() &&
      !WriteJson(ToJson(*scenario, options.scenario.Overrides(), sweep), options.json, &error)) {
    std::cerr << "armada floor: " << error << '\n';
    return kExitFailed;
  }
  return kExitOk;
}

}  // namespace armada
