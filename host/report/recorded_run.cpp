#include "host/report/recorded_run.h"

#include <algorithm>
#include <fstream>

#include "host/report/report_error.h"

namespace armada {
namespace {

constexpr int kSchema = 1;

Json ReadMetrics(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw ReportError(path.string() + ": cannot be read");
  Json metrics = Json::parse(file);
  const Json& schema = RequireKey(metrics, "schema", "the top level");
  if (schema != kSchema) {
    throw ReportError(path.string() + ": schema is " + schema.dump() +
                      ", allowed: " + std::to_string(kSchema));
  }
  return metrics;
}

void RequireColumns(const CsvTable& table, std::initializer_list<const char*> names) {
  for (const char* name : names) table.Column(name);
}

CsvTable ReadTrace(const std::filesystem::path& path, int* joints) {
  CsvTable trace(path);
  RequireColumns(trace,
                 {"t_s", "q1_rad", "x1_m", "x2_m", "v1_m_s", "v2_m_s", "xhat1_m", "xhat2_m", "vhat1_m_s",
                  "vhat2_m_s", "ahat1_m_s2", "ahat2_m_s2", "error_m", "manipulability", "synced"});
  *joints = 0;
  while (trace.Has("q" + std::to_string(*joints + 1) + "_rad")) ++*joints;
  for (int joint = 1; joint <= *joints; ++joint) trace.Column("tau" + std::to_string(joint) + "_Nm");
  return trace;
}

ArmRecord ReadArm(const std::filesystem::path& dir, const Json& metrics) {
  const int id = RequireKey(metrics, "id", "an arm").get<int>();
  const std::string part = "arm " + std::to_string(id);
  const std::string file_name = "arm_" + std::to_string(id) + ".csv";
  int joints = 0;
  ArmRecord arm{.id = id,
                .joints = 0,
                .subtask = RequireKey(metrics, "subtask", part).get<std::string>(),
                .diverged = RequireKey(metrics, "diverged", part).get<bool>(),
                .settled_s = std::nullopt,
                .metrics = metrics,
                .trace = ReadTrace(dir / file_name, &joints),
                .without_subtask = std::nullopt};
  arm.joints = joints;
  const Json& settled = RequireKey(metrics, "settled_s", part);
  if (!settled.is_null()) arm.settled_s = settled.get<double>();

  const std::filesystem::path twin = dir / "without_subtask";
  if (UsesSpareJoints(metrics) && std::filesystem::exists(twin)) {
    int twin_joints = 0;
    arm.without_subtask = ReadTrace(twin / file_name, &twin_joints);
    if (twin_joints != joints) {
      throw ReportError((twin / file_name).string() + ": " + std::to_string(twin_joints) + " joints, but " +
                        (dir / file_name).string() + " has " + std::to_string(joints));
    }
  }
  return arm;
}

}  // namespace

bool UsesSpareJoints(const Json& arm) {
  return arm.value("subtask", "none") != "none" || arm.contains("clearance_min_m") ||
         arm.contains("limit_margin_min_rad");
}

const Json& RequireKey(const Json& object, const std::string& key, const std::string& part) {
  const auto found = object.find(key);
  if (found == object.end()) throw ReportError("metrics.json: " + part + " has no key \"" + key + "\"");
  return *found;
}

RecordedRun LoadRecordedRun(const std::filesystem::path& dir) {
  if (!std::filesystem::is_directory(dir)) throw ReportError(dir.string() + ": is not a directory");
  try {
    const Json metrics = ReadMetrics(dir / "metrics.json");
    const Json& window = RequireKey(metrics, "window_s", "the top level");
    RecordedRun run{.metrics = metrics,
                    .window_start_s = window.at(0).get<double>(),
                    .window_end_s = window.at(1).get<double>(),
                    .leader = CsvTable(dir / "leader.csv"),
                    .arms = {},
                    .timing = std::nullopt};
    RequireColumns(run.leader, {"t_s", "x1_m", "x2_m", "v1_m_s", "v2_m_s", "a1_m_s2", "a2_m_s2"});
    run.start_s = run.leader.Column("t_s").front();
    run.end_s = std::max(run.leader.Column("t_s").back(), run.window_end_s);
    for (const Json& arm : RequireKey(metrics, "arms", "the top level")) {
      run.arms.push_back(ReadArm(dir, arm));
    }
    if (run.arms.empty()) throw ReportError((dir / "metrics.json").string() + ": lists no arms");
    if (std::filesystem::exists(dir / "timing.csv")) {
      run.timing = CsvTable(dir / "timing.csv");
      RequireColumns(*run.timing, {"arm", "t_s", "wakeup_lateness_us", "compute_us", "sample_to_torque_us"});
    }
    return run;
  } catch (const nlohmann::json::exception& problem) {
    throw ReportError((dir / "metrics.json").string() + ": " + problem.what());
  }
}

}  // namespace armada
