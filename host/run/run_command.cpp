#include "host/run/run_command.h"

#include <csignal>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "firmware/app/exit_codes.h"
#include "firmware/link/lcm_url.h"
#include "host/arm_table.h"
#include "host/run/fleet_run.h"
#include "host/run/run_buses.h"
#include "host/run/run_folder.h"
#include "host/run/run_in_vm.h"
#include "host/run/run_result.h"

namespace armada {
namespace {

int Fail(const std::string& message) {
  std::cerr << "armada run: " << message << '\n';
  return kExitFailed;
}

// What is wrong with the options of time; empty when nothing is.
std::string CheckTime(const RunOptions& options, const ScenarioConfig& scenario) {
  constexpr double kMinPace = 0.01;
  constexpr double kMaxPace = 100.0;
  if (options.time != "real" && options.time != "stepped") {
    return "--time " + options.time + ": there are real (the machine's time) and stepped (time that waits)";
  }
  if (options.time == "real") return options.pace == 1.0 ? "" : "--pace is for --time stepped";
  if (options.bus != "udp") return "--time stepped is for --bus udp: the kernel's CAN does not wait";
  if (options.pace != 0.0 && !(options.pace >= kMinPace && options.pace <= kMaxPace))
    return "--pace: allowed are 0, as fast as it goes, and 0.01 to 100";
  std::string error;
  const auto url = ParseLcmUrl(scenario.fleet.link.lcm_url, &error);
  if (url && url->ttl > 0)
    return "--time stepped: link.lcm_url has ttl=" + std::to_string(url->ttl) + ", other boards do not wait";
  for (const FaultConfig& fault : scenario.faults) {
    if (fault.kind != FaultKind::kCpuHog) continue;
    std::cerr << "armada run: fault cpu_hog at " << fault.at_s
              << " s is left out: computing takes no stepped time\n";
  }
  return error;
}

}  // namespace

int RunRunCommand(const RunOptions& options) {
  // A reader that is gone and a file that may not grow are errors to be told, not ends of this process.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  auto scenario = options.scenario.Load();
  if (!scenario) return kExitBadConfig;
  if (const std::string wrong = ChooseBuses(options, &scenario->fleet); !wrong.empty()) {
    std::cerr << "armada run: " << wrong << '\n';
    return kExitUsage;
  }
  if (!scenario->network.lost.empty()) {
    std::cerr << "armada run: network.lost is of virtual time, which `armada sim` runs\n";
    return kExitUsage;
  }
  if (!scenario->operations.empty()) {
    std::cerr << "armada run: [[operator]] is of virtual time; here `armada ctl` asks\n";
    return kExitUsage;
  }
  if (const std::string wrong = CheckTime(options, *scenario); !wrong.empty()) {
    std::cerr << "armada run: " << wrong << '\n';
    return kExitUsage;
  }
  std::string error;
  bool in_use = false;
  const auto folder = RunFolder::Take(options.out, &in_use, &error);
  if (folder == nullptr) {
    const int code = Fail(error);
    return in_use ? kExitUsage : code;
  }
  if (options.bus == "vm") {
    folder->KeepAcrossExec();
    EmptyRunFolder(options.out);
    return RunInVm(options, *scenario);
  }
  std::cout << scenario->name << ": " << scenario->fleet.arms.size() << " arms, " << scenario->seconds
            << " s, seed " << options.seed << ", into " << options.out << std::endl;
  FleetRun run(options, *folder, std::move(*scenario));
  RunMetrics metrics;
  nlohmann::ordered_json json;
  if (!run.Prepare(&error) || !run.Execute(&error) || !run.Collect(&metrics, &json, &error)) {
    const int code = Fail(error);
    PrintFindings(run.DiagnoseEnd(error), false, std::cerr);
    return run.interrupted() ? kExitInterrupted : code;
  }
  PrintArmTable(metrics, std::cout);
  if (options.time == "stepped") {
    const double stepped_s = json.at("stepped").at("stepped_s").get<double>();
    const double real_s = json.at("stepped").at("timing").at("real_s").get<double>();
    std::printf("stepped time: %.1f s in %.1f s, %.1f times real time; computing took none of it\n",
                stepped_s, real_s, stepped_s / real_s);
  } else {
    PrintProcessTable(json, std::cout);
  }
  PrintFindings(run.findings(), metrics.ok, std::cout);
  return metrics.ok ? kExitOk : kExitFailed;
}

}  // namespace armada
