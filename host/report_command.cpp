#include "host/report_command.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "firmware/app/exit_codes.h"
#include "hil/scenario_file.h"
#include "host/report/recorded_run.h"
#include "host/report/report.h"
#include "host/run/run_folder.h"
#include "host/sim/sim_command.h"

namespace armada {
namespace {

// The same scenario and seed with every subtask off, in virtual time.
int SimulateWithoutSubtasks(const std::string& directory) {
  std::vector<ConfigError> errors;
  const auto scenario = LoadScenario(
      directory + "/scenario.toml",
      {"arm.*.control.subtask.kind=none", "arm.*.control.subtask.avoidance.enabled=false"}, &errors);
  if (!scenario) {
    PrintErrors(errors, std::cerr);
    return kExitBadConfig;
  }
  std::ifstream file(directory + "/metrics.json");
  const auto json = nlohmann::ordered_json::parse(file, nullptr, false);
  if (json.is_discarded() || !json.contains("seed")) {
    std::cerr << "armada report: " << directory << "/metrics.json is missing or not of a run\n";
    return kExitFailed;
  }
  const auto& arms = json.at("arms");
  if (std::none_of(arms.begin(), arms.end(), UsesSpareJoints)) return kExitOk;
  RunMetrics metrics;
  std::string error;
  if (!SimulateInto(*scenario, json.at("seed").get<uint64_t>(), directory + "/without_subtask", false,
                    &metrics, &error)) {
    std::cerr << "armada report: " << error << '\n';
    return kExitFailed;
  }
  return kExitOk;
}

}  // namespace

int RunReportCommand(const std::string& path) {
  // A sweep is one file; a run, a directory.
  std::filesystem::path sweep = path;
  if (std::filesystem::is_directory(path)) sweep /= "sweep.json";
  const bool of_run = std::filesystem::is_directory(path) &&
                      (std::filesystem::exists(path + "/metrics.json") || !std::filesystem::exists(sweep));
  std::string error;
  bool in_use = false;
  const auto folder = of_run ? RunFolder::Take(path, &in_use, &error) : nullptr;
  if (of_run && folder == nullptr) {
    std::cerr << "armada report: " << error << '\n';
    return in_use ? kExitUsage : kExitFailed;
  }
  if (of_run && std::filesystem::exists(path + "/scenario.toml")) {
    if (const int code = SimulateWithoutSubtasks(path); code != kExitOk) return code;
  }
  if (!(of_run ? WriteReport(path, &error) : WriteSweepReport(sweep, &error))) {
    std::cerr << "armada report: " << error << '\n';
    return kExitFailed;
  }
  std::cout << (of_run ? path + "/report.html" : sweep.replace_extension(".html").string()) << '\n';
  return kExitOk;
}

}  // namespace armada
