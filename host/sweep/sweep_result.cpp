#include "host/sweep/sweep_result.h"

#include <algorithm>
#include <cmath>

namespace armada {
namespace {

using Json = nlohmann::ordered_json;

struct Sample {
  double value;
  uint64_t seed;
};

Distribution DistributionOf(std::vector<Sample> samples) {
  if (samples.empty()) return {};
  std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) {
    return a.value != b.value ? a.value < b.value : a.seed < b.seed;
  });
  const auto at = [&](double share) {
    const auto rank = static_cast<size_t>(std::ceil(share * static_cast<double>(samples.size())));
    return samples[std::clamp<size_t>(rank, 1, samples.size()) - 1].value;
  };
  return {static_cast<int64_t>(samples.size()),
          at(0.5),
          at(0.95),
          at(0.999),
          samples.back().value,
          samples.back().seed};
}

Json ToJson(const Distribution& distribution) {
  if (distribution.count == 0) return nullptr;
  return {{"median", distribution.median},
          {"p95", distribution.p95},
          {"p99.9", distribution.p999},
          {"max", distribution.max},
          {"worst_seed", distribution.worst_seed}};
}

std::optional<double> FloorFromJson(const Json& json) {
  const auto found = json.find("floor_rms_mm");
  return found == json.end() ? std::nullopt : std::optional(found->get<double>());
}

SeedResult RunFromJson(const Json& json) {
  SeedResult run;
  run.seed = json.at("seed").get<uint64_t>();
  run.ok = json.at("ok").get<bool>();
  run.fleet_rms_mm = json.at("fleet_rms_mm").get<double>();
  run.floor_rms_mm = FloorFromJson(json);
  for (const Json& entry : json.at("arms")) {
    SeedResult::Arm arm;
    arm.id = entry.at("id").get<int>();
    arm.diverged = entry.at("diverged").get<bool>();
    if (!entry.at("settled_s").is_null()) arm.settled_s = entry.at("settled_s").get<double>();
    arm.rms_mm = entry.at("rms_mm").get<double>();
    arm.max_mm = entry.at("max_mm").get<double>();
    arm.estimator_x_m = entry.at("estimator_x").get<double>();
    arm.floor_rms_mm = FloorFromJson(entry);
    run.arms.push_back(arm);
  }
  return run;
}

Json ToJson(const SeedResult& run) {
  Json arms = Json::array();
  for (const SeedResult::Arm& arm : run.arms) {
    arms.push_back({{"id", arm.id},
                    {"diverged", arm.diverged},
                    {"settled_s", arm.settled_s ? Json(*arm.settled_s) : Json(nullptr)},
                    {"rms_mm", arm.rms_mm},
                    {"max_mm", arm.max_mm},
                    {"estimator_x", arm.estimator_x_m}});
    if (arm.floor_rms_mm) arms.back()["floor_rms_mm"] = *arm.floor_rms_mm;
  }
  Json json = {{"seed", run.seed}, {"ok", run.ok}, {"fleet_rms_mm", run.fleet_rms_mm}};
  if (run.floor_rms_mm) json["floor_rms_mm"] = *run.floor_rms_mm;
  json["arms"] = arms;
  return json;
}

bool HaveFloors(const std::vector<SeedResult>& runs) {
  return !runs.empty() && runs.front().floor_rms_mm.has_value();
}

}  // namespace

SeedResult SeedResult::Of(const RunMetrics& metrics) {
  const auto in_mm = [](const std::optional<double>& m) {
    return m ? std::optional(*m * 1e3) : std::nullopt;
  };
  SeedResult run{metrics.seed, metrics.ok, metrics.fleet_rms_m * 1e3, in_mm(metrics.floor_rms_m), {}};
  for (const ArmMetrics& arm : metrics.arms) {
    run.arms.push_back({arm.id, arm.diverged, arm.settled_s, arm.rms_m * 1e3, arm.max_m * 1e3,
                        arm.estimator_rms.x_m, in_mm(arm.floor_rms_m)});
  }
  return run;
}

SweepSummary Summarize(const std::vector<SeedResult>& runs) {
  SweepSummary summary;
  summary.count = static_cast<int64_t>(runs.size());
  summary.has_floors = HaveFloors(runs);
  double ok_squares = 0.0;
  double floor_squares = 0.0;
  std::vector<Sample> fleets;
  double estimator_squares = 0.0;
  int64_t estimates = 0;
  for (const SeedResult& run : runs) {
    fleets.push_back({run.fleet_rms_mm, run.seed});
    if (run.ok) {
      ++summary.ok_count;
      ok_squares += run.fleet_rms_mm * run.fleet_rms_mm;
      if (run.floor_rms_mm) floor_squares += *run.floor_rms_mm * *run.floor_rms_mm;
    } else {
      summary.failed_seeds.push_back(run.seed);
    }
    for (const SeedResult::Arm& arm : run.arms) {
      estimator_squares += arm.estimator_x_m * arm.estimator_x_m;
      ++estimates;
    }
  }
  if (summary.ok_count > 0)
    summary.fleet_rms_mm = std::sqrt(ok_squares / static_cast<double>(summary.ok_count));
  if (summary.has_floors && summary.ok_count > 0)
    summary.floor_rms_mm = std::sqrt(floor_squares / static_cast<double>(summary.ok_count));
  if (estimates > 0)
    summary.estimator_rms_x_m = std::sqrt(estimator_squares / static_cast<double>(estimates));

  summary.fleet_rms_all_mm = DistributionOf(std::move(fleets));

  const size_t arm_count = runs.empty() ? 0 : runs.front().arms.size();
  for (size_t i = 0; i < arm_count; ++i) {
    SweepArmSummary arm;
    arm.id = runs.front().arms[i].id;
    std::vector<Sample> rms, max, settled, floor, over_floor;
    for (const SeedResult& run : runs) {
      const SeedResult::Arm& of_run = run.arms[i];
      if (of_run.diverged) {
        ++arm.diverged;
      } else {
        rms.push_back({of_run.rms_mm, run.seed});
        max.push_back({of_run.max_mm, run.seed});
        if (of_run.floor_rms_mm) {
          floor.push_back({*of_run.floor_rms_mm, run.seed});
          over_floor.push_back({of_run.rms_mm / *of_run.floor_rms_mm, run.seed});
        }
      }
      if (of_run.settled_s) {
        settled.push_back({*of_run.settled_s, run.seed});
      } else {
        ++arm.never_settled;
      }
    }
    arm.rms_mm = DistributionOf(std::move(rms));
    arm.max_mm = DistributionOf(std::move(max));
    arm.settled_s = DistributionOf(std::move(settled));
    arm.floor_mm = DistributionOf(std::move(floor));
    arm.over_floor = DistributionOf(std::move(over_floor));
    summary.arms.push_back(arm);
  }
  return summary;
}

Json ToJson(const Sweep& sweep) {
  const SweepSummary summary = Summarize(sweep.runs);
  Json arms = Json::array();
  for (const SweepArmSummary& arm : summary.arms) {
    arms.push_back({{"id", arm.id},
                    {"diverged", arm.diverged},
                    {"never_settled", arm.never_settled},
                    {"rms_mm", ToJson(arm.rms_mm)},
                    {"max_mm", ToJson(arm.max_mm)},
                    {"settled_s", ToJson(arm.settled_s)}});
    if (!summary.has_floors) continue;
    arms.back()["floor_mm"] = ToJson(arm.floor_mm);
    arms.back()["over_floor"] = ToJson(arm.over_floor);
  }
  Json runs = Json::array();
  for (const SeedResult& run : sweep.runs) runs.push_back(ToJson(run));
  Json json = {{"schema", 1},
               {"mode", "sweep"},
               {"scenario", sweep.scenario},
               {"set", sweep.overrides},
               {"count", summary.count},
               {"ok_count", summary.ok_count},
               {"fleet_rms_mm", summary.fleet_rms_mm ? Json(*summary.fleet_rms_mm) : Json(nullptr)},
               {"fleet_rms_all_mm", ToJson(summary.fleet_rms_all_mm)}};
  if (summary.floor_rms_mm) {
    json["floor_rms_mm"] = *summary.floor_rms_mm;
    json["over_floor"] = *summary.fleet_rms_mm / *summary.floor_rms_mm;
  }
  json["estimator_rms_x"] = summary.estimator_rms_x_m;
  json["failed_seeds"] = summary.failed_seeds;
  json["arms"] = arms;
  json["runs"] = runs;
  return json;
}

std::optional<Sweep> SweepFromJson(const Json& json, std::string* error) {
  try {
    if (json.at("schema") != 1 || json.at("mode") != "sweep") {
      *error = "not a sweep of schema 1";
      return std::nullopt;
    }
    Sweep sweep{json.at("scenario").get<std::string>(), json.at("set").get<std::vector<std::string>>(), {}};
    for (const Json& run : json.at("runs")) sweep.runs.push_back(RunFromJson(run));
    return sweep;
  } catch (const nlohmann::json::exception& exception) {
    *error = exception.what();
    return std::nullopt;
  }
}

std::optional<Sweep> Merge(const std::vector<Sweep>& shards, std::string* error) {
  Sweep merged{shards.front().scenario, shards.front().overrides, {}};
  for (const Sweep& shard : shards) {
    if (shard.scenario != merged.scenario || shard.overrides != merged.overrides) {
      *error =
          "the files are of different scenarios or settings: " + merged.scenario + " and " + shard.scenario;
      return std::nullopt;
    }
    merged.runs.insert(merged.runs.end(), shard.runs.begin(), shard.runs.end());
  }
  if (std::any_of(merged.runs.begin(), merged.runs.end(), [&](const SeedResult& run) {
        return run.floor_rms_mm.has_value() != HaveFloors(merged.runs);
      })) {
    *error = "some of the files have floors, some do not";
    return std::nullopt;
  }
  std::sort(merged.runs.begin(), merged.runs.end(),
            [](const SeedResult& a, const SeedResult& b) { return a.seed < b.seed; });
  const auto twice =
      std::adjacent_find(merged.runs.begin(), merged.runs.end(),
                         [](const SeedResult& a, const SeedResult& b) { return a.seed == b.seed; });
  if (twice != merged.runs.end()) {
    *error = "seed " + std::to_string(twice->seed) + " is in two of the files";
    return std::nullopt;
  }
  return merged;
}

}  // namespace armada
