#include "hil/hil_report.h"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "firmware/app/whole_file.h"

namespace armada {
namespace {

using Json = nlohmann::ordered_json;

const char* NameOf(HilEnd end) {
  switch (end) {
    case HilEnd::kDone:
      return "done";
    case HilEnd::kStopped:
      return "stopped";
    case HilEnd::kBusDown:
      return "bus down";
  }
  return "";
}

template <class T>
Json OrNull(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json ToJson(const BusCounters& counters, double load) {
  return {{"can_load", load},
          {"can_sent", counters.sent},
          {"can_received", counters.received},
          {"can_dropped", counters.dropped_queue_full + counters.dropped_late},
          {"can_receive_overflowed", counters.receive_overflowed},
          {"can_malformed", counters.malformed},
          {"can_errors", counters.errors}};
}

Json ToJson(const CanLog& log) {
  return {{"file", std::filesystem::path(log.path()).filename().string()},
          {"frames", log.recorded()},
          {"dropped", log.dropped()}};
}

Json ToJson(const std::vector<FaultConfig>& faults) {
  Json json = Json::array();
  for (const FaultConfig& fault : faults)
    json.push_back({{"kind", NameOf(fault.kind)}, {"arm", fault.arm}, {"at_s", fault.at_s}});
  return json;
}

Json ToJson(const std::vector<DrivePower>& drives) {
  Json json = Json::array();
  for (const DrivePower& drive : drives) {
    json.push_back({{"on_s", OrNull(drive.on_s)}, {"off_s", OrNull(drive.off_s)}});
  }
  return json;
}

Json ToJson(const HilArmResult& arm, const CanLog& log) {
  const bool measured =
      arm.record && arm.record->count() > 0;  // the window was reached, and there is a leader
  return {{"id", arm.id},
          {"diverged", arm.diverged},
          {"released_s", OrNull(arm.released_s)},
          {"drives", ToJson(arm.drives)},
          {"settled_s", arm.record ? OrNull(arm.record->settled_s()) : Json(nullptr)},
          {"rms_mm", measured ? Json(arm.record->rms_m() * 1e3) : Json(nullptr)},
          {"max_mm", measured ? Json(arm.record->max_m() * 1e3) : Json(nullptr)},
          {"max_at_s", measured ? OrNull(arm.record->max_at_s()) : Json(nullptr)},
          {"beyond_at_s", measured ? OrNull(arm.record->beyond_at_s()) : Json(nullptr)},
          {"samples", arm.record ? arm.record->count() : 0},
          {"bus_name", arm.bus},
          {"bus", ToJson(arm.counters, arm.bus_load)},
          {"can_log", ToJson(log)}};
}

Json Percentiles(const DurationHistogram& histogram) {
  return {{"p50", histogram.PercentileUs(0.5)},
          {"p99", histogram.PercentileUs(0.99)},
          {"p99.9", histogram.PercentileUs(0.999)},
          {"max", histogram.max_us()}};
}

}  // namespace

bool WriteHilReport(const HilReport& report, const std::vector<std::unique_ptr<CanLog>>& logs,
                    const std::string& path, std::string* error) {
  Json arms = Json::array();
  for (size_t i = 0; i < report.arms.size(); ++i) arms.push_back(ToJson(report.arms[i], *logs[i]));
  const Json json = {
      {"schema", 1},
      {"name", "hil"},
      {"scenario", report.scenario},
      {"seed", report.seed},
      {"epoch_ns", report.epoch_ns},
      {"epoch_wall_ns", report.epoch_wall_ns},
      {"seconds", report.seconds},
      {"end", NameOf(report.end)},
      {"faults_taken", ToJson(report.faults_taken)},
      {"arms", arms},
      {"timing",
       {{"pacing_us", Percentiles(report.pacing)},
        {"latest_at_s", report.latest_at_s},
        {"ticks", report.pacing.count()},
        {"realtime_priority", report.grant.fifo}}},
      {"memory",
       {{"heap_allocations", OrNull(report.heap_allocations)},
        {"page_faults", report.page_faults},
        {"locked", report.grant.memory_locked}}},
  };
  return WriteWhole(
      path, [&](std::ostream& file) { file << json.dump(2) << '\n'; }, error);
}

}  // namespace armada
