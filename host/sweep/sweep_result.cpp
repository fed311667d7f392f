#include "host/sweep/sweep_result.h"

#include "firmware/app/whole_file.h"
#include "host/json.h"
#include "host/shell_quote.h"

namespace armada {
namespace {

Json ToJson(const Sweep& sweep, const WorstSeeds& worst) {
  Json list = Json::array();
  for (const WorstSeed& entry : worst.list()) {
    list.push_back({{"seed", entry.seed},
                    {"arm", entry.arm},
                    {"value", entry.value},
                    {"command", ReplayCommand(sweep, entry.seed)}});
  }
  return list;
}

Json ToJson(const SweepArmSummary& arm, bool has_floors) {
  Json json = {{"id", arm.id},
               {"diverged", arm.diverged},
               {"never_settled", arm.never_settled},
               {"rms_mm", ToJson(arm.rms_mm)},
               {"max_mm", ToJson(arm.max_mm)},
               {"settled_s", ToJson(arm.settled_s)}};
  if (has_floors) {
    json["floor_mm"] = ToJson(arm.floor_mm);
    json["over_floor"] = ToJson(arm.over_floor);
  }
  return json;
}

// An array of objects has a line for each, all else one line.
void WriteValue(const Json& value, std::ostream& out) {
  if (!value.is_array() || value.empty() || !value.front().is_object()) {
    out << value.dump();
    return;
  }
  const char* separator = "[\n    ";
  for (const Json& element : value) {
    out << separator << element.dump();
    separator = ",\n    ";
  }
  out << "\n  ]";
}

}  // namespace

std::string ReplayCommand(const Sweep& sweep) {
  std::string command = "armada sim " + ShellQuoted(sweep.scenario_file);
  for (const std::string& set : sweep.overrides) command += " --set " + ShellQuoted(set);
  return command + " --seed";
}

std::string ReplayCommand(const Sweep& sweep, uint64_t seed) {
  return ReplayCommand(sweep) + " " + std::to_string(seed);
}

Json HeaderJson(const Sweep& sweep, const SweepSummary& summary) {
  Json arms = Json::array();
  for (const SweepArmSummary& arm : summary.arms) arms.push_back(ToJson(arm, summary.has_floors));
  const size_t rows = sweep.results.rows();
  Json json = {{"schema", 1},
               {"mode", "sweep"},
               {"scenario", sweep.scenario},
               {"scenario_file", sweep.scenario_file},
               {"set", sweep.overrides},
               {"first_seed", rows > 0 ? Json(sweep.results.seed(0)) : Json(nullptr)},
               {"last_seed", rows > 0 ? Json(sweep.results.seed(rows - 1)) : Json(nullptr)},
               {"count", summary.count},
               {"ok_count", summary.ok_count},
               {"failed_count", summary.failed_count()},
               {"failed_seeds", summary.failed_seeds},
               {"replay", ReplayCommand(sweep)},
               {"fleet_rms_mm", summary.fleet_rms_mm ? Json(*summary.fleet_rms_mm) : Json(nullptr)}};
  if (summary.floor_rms_mm) {
    json["floor_rms_mm"] = *summary.floor_rms_mm;
    json["over_floor"] = *summary.fleet_rms_mm / *summary.floor_rms_mm;
  }
  json["estimator_rms_x"] = summary.estimator_rms_x_m;
  json["bins_per_decade"] = LogHistogram::kBinsPerDecade;
  json["fleet_rms_all_mm"] = ToJson(summary.fleet_rms_all_mm);
  if (summary.has_floors) json["fleet_over_floor"] = ToJson(summary.fleet_over_floor);
  json["fleet_max_mm"] = ToJson(summary.fleet_max_mm);
  json["fleet_settled_s"] = ToJson(summary.fleet_settled_s);
  json["worst"] = {{"settled_s", ToJson(sweep, summary.worst_settled_s)},
                   {"rms_mm", ToJson(sweep, summary.worst_rms_mm)},
                   {"max_mm", ToJson(sweep, summary.worst_max_mm)}};
  json["arms"] = arms;
  return json;
}

bool WriteSweep(const Sweep& sweep, const SweepSummary& summary, const std::string& path,
                std::string* error) {
  const auto write = [&](std::ostream& out) {
    out << "{\n";
    const Json header = HeaderJson(sweep, summary);
    for (const auto& [key, value] : header.items()) {
      out << "  " << Json(key) << ": ";
      WriteValue(value, out);
      out << ",\n";
    }
    out << "  \"runs\": [";
    for (size_t row = 0; row < sweep.results.rows(); ++row)
      out << (row == 0 ? "\n    " : ",\n    ") << ToJson(sweep.results.At(row)).dump();
    out << "\n  ]\n}\n";
  };
  return WriteWhole(path, write, error);
}

}  // namespace armada
