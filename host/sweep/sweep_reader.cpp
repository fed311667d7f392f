// Reading and joining sweeps, in memory that does not grow with the number of seeds.

#include <fstream>
#include <functional>
#include <stdexcept>

#include "host/json.h"
#include "host/sweep/sweep_result.h"

namespace armada {
namespace {

// The whole file but for its runs, of which each is handed to `on_run`.
Json Parse(const std::string& path, const std::function<void(const Json& run)>& on_run) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot be read");
  constexpr int kOfWhole = 1;
  constexpr int kOfList = 2;
  bool in_runs = false;
  Json header = Json::parse(file, [&](int depth, Json::parse_event_t event, Json& parsed) {
    if (depth == kOfWhole && event == Json::parse_event_t::key) in_runs = parsed == "runs";
    if (!in_runs || depth != kOfList || event != Json::parse_event_t::object_end) return true;
    on_run(parsed);
    return false;
  });
  if (header.at("schema") != 1 || header.at("mode") != "sweep" || !header.at("runs").is_array())
    throw std::runtime_error("not a sweep of schema 1");
  return header;
}

Sweep ReadOrThrow(const std::string& path) {
  size_t rows = 0;
  const Json header = Parse(path, [&](const Json&) { ++rows; });
  std::vector<int> arm_ids;
  for (const Json& arm : header.at("arms")) arm_ids.push_back(arm.at("id").get<int>());
  Sweep sweep{header.at("scenario").get<std::string>(), header.value("scenario_file", ""),
              header.at("set").get<std::vector<std::string>>(), ResultTable(rows, std::move(arm_ids))};
  size_t row = 0;
  Parse(path, [&](const Json& run) {
    const SeedResult result = SeedResultFromJson(run);
    const std::string seed = "seed " + std::to_string(result.seed);
    if (row > 0 && result.seed <= sweep.results.seed(row - 1))
      throw std::runtime_error(seed + " stands after a larger or equal one");
    if (result.arms.size() != sweep.results.arm_ids().size())
      throw std::runtime_error(seed + " has another number of arms");
    sweep.results.Set(row++, result);
  });
  return sweep;
}

}  // namespace

std::optional<Sweep> ReadSweep(const std::string& path, std::string* error) {
  try {
    return ReadOrThrow(path);
  } catch (const std::exception& problem) {
    *error = path + ": " + problem.what();
    return std::nullopt;
  }
}

std::optional<Sweep> Merge(const std::vector<Sweep>& shards, std::string* error) {
  const Sweep& first = shards.front();
  size_t rows = 0;
  bool has_floors = false;
  for (const Sweep& shard : shards) {
    if (shard.scenario != first.scenario || shard.overrides != first.overrides ||
        shard.results.arm_ids() != first.results.arm_ids()) {
      *error =
          "the files are of different scenarios or settings: " + first.scenario + " and " + shard.scenario;
      return std::nullopt;
    }
    if (shard.results.rows() > 0 && rows > 0 && shard.results.has_floors() != has_floors) {
      *error = "some of the files have floors, some do not";
      return std::nullopt;
    }
    if (shard.results.rows() > 0) has_floors = shard.results.has_floors();
    rows += shard.results.rows();
  }
  Sweep merged{first.scenario, first.scenario_file, first.overrides,
               ResultTable(rows, first.results.arm_ids())};
  std::vector<size_t> next(shards.size(), 0);  // row of each shard
  for (size_t row = 0; row < rows; ++row) {
    size_t least = shards.size();
    for (size_t i = 0; i < shards.size(); ++i) {
      if (next[i] == shards[i].results.rows()) continue;
      if (least == shards.size() || shards[i].results.seed(next[i]) < shards[least].results.seed(next[least]))
        least = i;
    }
    const SeedResult result = shards[least].results.At(next[least]++);
    if (row > 0 && result.seed == merged.results.seed(row - 1)) {
      *error = "seed " + std::to_string(result.seed) + " is in two of the files";
      return std::nullopt;
    }
    merged.results.Set(row, result);
  }
  return merged;
}

}  // namespace armada
