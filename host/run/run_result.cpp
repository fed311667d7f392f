#include "host/run/run_result.h"

#include <cstdio>
#include <fstream>
#include <optional>
#include <ostream>

#include "host/json.h"

namespace armada {
namespace {

std::optional<Json> ReadJson(const std::string& path, std::string* error) {
  std::ifstream file(path);
  if (!file) {
    *error = "cannot read " + path;
    return std::nullopt;
  }
  Json json = Json::parse(file, nullptr, false);
  if (json.is_discarded()) {
    *error = path + " is not JSON";
    return std::nullopt;
  }
  return json;
}

// The true errors at 1 kHz from the emulation; without a leader it cannot know them, and the boards' own are
// used.
void TakeTracking(const Json& of_arm, const TrackingRecord& seen, ArmMetrics* arm) {
  arm->diverged = of_arm.at("diverged").get<bool>();
  if (of_arm.at("rms_mm").is_null()) {
    arm->settled_s = seen.settled_s();
    arm->rms_m = seen.rms_m();
    arm->max_m = seen.max_m();
    arm->max_at_s = seen.max_at_s();
    arm->beyond_at_s = seen.beyond_at_s();
    return;
  }
  const auto time = [&](const char* key) {
    const Json& at_s = of_arm.at(key);
    return at_s.is_null() ? std::nullopt : std::optional(at_s.get<double>());
  };
  arm->settled_s = time("settled_s");
  arm->max_at_s = time("max_at_s");
  arm->beyond_at_s = time("beyond_at_s");
  arm->rms_m = 1e-3 * of_arm.at("rms_mm").get<double>();
  arm->max_m = 1e-3 * of_arm.at("max_mm").get<double>();
}

Json ToJson(const std::vector<ProcessFaults::Made>& faults) {
  Json json = Json::array();
  for (const ProcessFaults::Made& made : faults) {
    json.push_back({{"what", made.what}, {"to", made.to}, {"at_s", made.at_s}, {"made_s", made.made_s}});
  }
  return json;
}

}  // namespace

bool CollectRunResult(const ScenarioConfig& scenario, uint64_t seed, const RunRecorder& recorder,
                      const ProcessFaults& faults, const std::string& directory, RunMetrics* metrics,
                      Json* json, std::string* error) {
  const auto hil = ReadJson(directory + "/hil.json", error);
  if (!hil) return false;
  metrics->scenario = scenario.name;
  metrics->scenario_file = scenario.file;
  metrics->mode = "run";
  metrics->law = scenario.fleet.arms.front().control.law;
  metrics->estimator = scenario.fleet.estimator.kind;
  metrics->seed = seed;
  metrics->seconds = scenario.seconds;
  metrics->window_start_s = scenario.window_start_s;
  metrics->estimate_spread_m = recorder.EstimateSpread();

  std::vector<std::optional<Json>> boards;
  try {
    for (size_t i = 0; i < scenario.fleet.arms.size(); ++i) {
      const int id = scenario.fleet.arms[i].id;
      const bool dead = faults.dead_arms().contains(id);
      auto& board = boards.emplace_back();
      if (!dead) board = ReadJson(directory + "/arm_" + std::to_string(id) + ".json", error);
      if (!dead && !board) return false;
      ArmMetrics arm = recorder.Metrics(i);
      TakeTracking(hil->at("arms").at(i), recorder.Tracking(i), &arm);
      arm.state = dead ? "DEAD" : board->at("state").get<std::string>();
      if (!dead) arm.faults = board->at("faults").get<std::vector<std::string>>();
      metrics->arms.push_back(std::move(arm));
    }
    metrics->Judge(scenario.criterion);
    *json = ToJson(*metrics);
    for (size_t i = 0; i < boards.size(); ++i) {
      for (const char* section : {"timing", "memory", "bus"}) {
        if (boards[i]) (*json)["arms"][i][section] = boards[i]->at(section);
      }
      Json& bus = (*json)["arms"][i]["bus"];
      bus["can_load"] = hil->at("arms").at(i).at("bus").at("can_load");
    }
    if (!faults.made().empty()) (*json)["process_faults"] = ToJson(faults.made());
    (*json)["hil"] = {{"name", "hil"}, {"timing", hil->at("timing")}, {"memory", hil->at("memory")}};
  } catch (const nlohmann::json::exception& exception) {
    *error = directory + ": " + exception.what();
    return false;
  }
  return true;
}

void PrintProcessTable(const Json& json, std::ostream& out) {
  out << "arm  lateness_us: p50    p99      max  compute_us: p50    p99  sample->torque_us: p50    p99  "
         "missed  heap  faults\n";
  for (const Json& arm : json.at("arms")) {
    if (!arm.contains("timing")) continue;  // its controller is dead
    const Json& timing = arm.at("timing");
    const Json& memory = arm.at("memory");
    const auto us = [&](const char* what, const char* which) {
      return timing.at(what).at(which).get<double>();
    };
    const Json& heap = memory.at("heap_allocations");
    char line[200];
    std::snprintf(line, sizeof line,
                  "%3d  %16.0f  %5.0f  %7.0f  %15.0f  %5.0f  %22.0f  %5.0f  %6lld  %4s  %6lld\n",
                  arm.at("id").get<int>(), us("wakeup_lateness_us", "p50"), us("wakeup_lateness_us", "p99"),
                  us("wakeup_lateness_us", "max"), us("compute_us", "p50"), us("compute_us", "p99"),
                  us("sample_to_torque_us", "p50"), us("sample_to_torque_us", "p99"),
                  timing.at("missed_ticks").get<long long>(), heap.is_null() ? "-" : heap.dump().c_str(),
                  memory.at("page_faults").get<long long>());
    out << line;
  }
}

}  // namespace armada
