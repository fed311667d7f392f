#include "host/report/process_table.h"

#include <algorithm>
#include <array>
#include <span>

namespace armada {
namespace {

constexpr std::array<const char*, 3> kSections = {"timing", "memory", "bus"};

std::string NameOf(const Json& object, const std::string& key) {
  if (object.contains("name")) return object["name"].get<std::string>();
  if (object.contains("id")) return "arm " + object["id"].dump();
  return key.empty() ? "run" : key;
}

/// Of a list of objects one: the sums of their numbers, without what tells them apart.
Json SumOf(const Json& list) {
  Json sum = Json::object();
  for (const Json& part : list) {
    for (const auto& [key, number] : part.items()) {
      if (key == "from" || !number.is_number_integer()) continue;
      sum[key] = sum.value(key, int64_t{0}) + number.get<int64_t>();
    }
  }
  return sum;
}

void AddValues(const Json& value, const std::string& quantity, const std::string& process,
               ProcessTable* table) {
  if (value.is_array() && !value.empty() && value.front().is_object()) {
    return AddValues(SumOf(value), quantity, process, table);
  }
  if (value.is_object()) {
    const std::string prefix = quantity + ".";
    for (const auto& [key, part] : value.items()) AddValues(part, prefix + key, process, table);
    return;
  }
  if (std::find(table->quantities.begin(), table->quantities.end(), quantity) == table->quantities.end()) {
    table->quantities.push_back(quantity);
  }
  table->values[{quantity, process}] = value;
}

/// `sections` of every process below `value`.
void Collect(const Json& value, const std::string& key, std::span<const char* const> sections,
             ProcessTable* table) {
  const bool is_process =
      value.is_object() &&
      std::any_of(sections.begin(), sections.end(), [&](const char* name) { return value.contains(name); });
  if (is_process) {
    const std::string name = NameOf(value, key);
    table->processes.push_back(name);
    for (const char* section : sections) {
      if (value.contains(section)) AddValues(value[section], section, name, table);
    }
    return;
  }
  if (!value.is_structured()) return;
  for (const auto& [part_key, part] : value.items()) Collect(part, part_key, sections, table);
}

}  // namespace

ProcessTable CollectProcesses(const Json& metrics) {
  ProcessTable table;
  // Of stepped time there are no timings: computing took none.
  const std::span all(kSections);
  Collect(metrics, "", metrics.contains("stepped") ? all.subspan(1) : all, &table);
  return table;
}

}  // namespace armada
