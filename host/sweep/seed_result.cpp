#include "host/sweep/seed_result.h"

#include "host/json.h"

namespace armada {

namespace {

std::optional<double> FloorFromJson(const Json& json) {
  const auto found = json.find("floor_rms_mm");
  return found == json.end() ? std::nullopt : std::optional(found->get<double>());
}

}  // namespace

SeedResult SeedResult::Of(const RunMetrics& metrics) {
  const auto in_mm = [](const std::optional<double>& m) {
    return m ? std::optional(*m * 1e3) : std::nullopt;
  };
  SeedResult result{metrics.seed, metrics.ok, metrics.fleet_rms_m * 1e3, in_mm(metrics.floor_rms_m), {}};
  for (const ArmMetrics& arm : metrics.arms) {
    result.arms.push_back({arm.id, arm.diverged, arm.settled_s, arm.rms_m * 1e3, arm.max_m * 1e3,
                           arm.estimator_rms.x_m, in_mm(arm.floor_rms_m)});
  }
  return result;
}

std::vector<int> ArmIds(const ScenarioConfig& scenario) {
  std::vector<int> ids;
  for (const ArmEntry& arm : scenario.fleet.arms) ids.push_back(arm.id);
  return ids;
}

Json ToJson(const SeedResult& result) {
  Json arms = Json::array();
  for (const SeedResult::Arm& arm : result.arms) {
    arms.push_back({{"id", arm.id},
                    {"diverged", arm.diverged},
                    {"settled_s", arm.settled_s ? Json(*arm.settled_s) : Json(nullptr)},
                    {"rms_mm", arm.rms_mm},
                    {"max_mm", arm.max_mm},
                    {"estimator_x", arm.estimator_x_m}});
    if (arm.floor_rms_mm) arms.back()["floor_rms_mm"] = *arm.floor_rms_mm;
  }
  Json json = {{"seed", result.seed}, {"ok", result.ok}, {"fleet_rms_mm", result.fleet_rms_mm}};
  if (result.floor_rms_mm) json["floor_rms_mm"] = *result.floor_rms_mm;
  json["arms"] = arms;
  return json;
}

SeedResult SeedResultFromJson(const Json& json) {
  SeedResult result;
  result.seed = json.at("seed").get<uint64_t>();
  result.ok = json.at("ok").get<bool>();
  result.fleet_rms_mm = json.at("fleet_rms_mm").get<double>();
  result.floor_rms_mm = FloorFromJson(json);
  for (const Json& entry : json.at("arms")) {
    SeedResult::Arm arm;
    arm.id = entry.at("id").get<int>();
    arm.diverged = entry.at("diverged").get<bool>();
    if (!entry.at("settled_s").is_null()) arm.settled_s = entry.at("settled_s").get<double>();
    arm.rms_mm = entry.at("rms_mm").get<double>();
    arm.max_mm = entry.at("max_mm").get<double>();
    arm.estimator_x_m = entry.at("estimator_x").get<double>();
    arm.floor_rms_mm = FloorFromJson(entry);
    result.arms.push_back(arm);
  }
  return result;
}

}  // namespace armada
