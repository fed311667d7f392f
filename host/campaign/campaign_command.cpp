#include "host/campaign/campaign_command.h"

#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <system_error>

#include "firmware/app/command_line.h"
#include "firmware/app/exit_codes.h"
#include "firmware/app/heap_counter.h"
#include "host/campaign/campaign.h"
#include "host/campaign/trial.h"
#include "host/metrics.h"
#include "host/scenario_arguments.h"

namespace armada {
namespace {

namespace fs = std::filesystem;

struct Options {
  ScenarioArguments scenario;
  CampaignOptions campaign;
};

int Fail(const std::string& message, int code) {
  std::cerr << "armada campaign: " << message << '\n';
  return code;
}

/// Why trials cannot be drawn from a scenario; empty when they can.
std::string Objection(const ScenarioConfig& scenario, bool replay) {
  if (scenario.leader.kind == LeaderKind::kNone) return "the scenario has no leader";
  if (scenario.fleet.topologies.size() > 1) return "the fleet has more than one topology";
  if (replay) return {};
  if (!scenario.faults.empty() || !scenario.operations.empty())
    return "the scenario has faults or an operator of its own: --replay judges it as it is";
  if (scenario.start.mode != StartMode::kRunning || scenario.start.kind != StartKind::kNearLeader)
    return "the fleet must start running and near the leader";
  if (scenario.seconds < kLastEvent_s + 3.0)
    return "the scenario must last " + std::to_string(kLastEvent_s + 3.0) + " s or more";
  return {};
}

std::string SeedsText(const CampaignOptions& options) {
  return std::to_string(options.first_seed) + ":" + std::to_string(options.first_seed + options.trials - 1);
}

nlohmann::ordered_json ToJson(const ScenarioConfig& scenario, const CampaignOptions& options,
                              const CampaignResult& result) {
  nlohmann::ordered_json json = {{"schema", 1},
                                 {"scenario", scenario.name},
                                 {"seeds", SeedsText(options)},
                                 {"trials", options.trials},
                                 {"heap_counted", HeapCounter::available()},
                                 {"ok", result.failed.empty()},
                                 {"failed", nlohmann::ordered_json::array()}};
  for (const FailedTrial& failed : result.failed) {
    json["failed"].push_back({{"seed", failed.seed},
                              {"invariant", TextOf(failed.violation.invariant)},
                              {"t_s", failed.violation.t_s},
                              {"arm", failed.violation.arm},
                              {"what", failed.violation.what},
                              {"violations", failed.violations},
                              {"script", failed.script}});
  }
  result.coverage.WriteTo(&json);
  return json;
}

void Print(const CampaignOptions& options, const CampaignResult& result) {
  result.coverage.Print(std::cout);
  std::cout << '\n';
  for (const FailedTrial& failed : result.failed) {
    std::cout << "seed " << failed.seed << ": broken: " << TextOf(failed.violation.invariant) << "\n  at "
              << failed.violation.t_s << " s, arm " << failed.violation.arm << ": " << failed.violation.what
              << (failed.violations > 1 ? ", and more" : "")
              << (failed.script.empty() ? "" : "\n  smallest script: " + failed.script) << '\n';
  }
  std::cout << options.trials << " trials, seeds " << SeedsText(options) << ": "
            << result.coverage.cells_tried() << " of " << result.coverage.cells()
            << " kinds of faults tried, " << result.coverage.transitions_taken() << " of "
            << Coverage::transitions() << " transitions taken, "
            << (HeapCounter::available() ? "" : "heap not counted, ") << result.failed.size()
            << " trials with a violation\n";
}

int Run(const Options& options) {
  const auto scenario = options.scenario.Load();
  if (!scenario) return kExitBadConfig;
  if (const std::string wrong = Objection(*scenario, options.campaign.replay); !wrong.empty())
    return Fail(options.scenario.scenario + ": " + wrong, kExitUsage);
  const bool terminal = isatty(STDERR_FILENO) != 0;
  try {
    fs::create_directories(options.campaign.directory);
    const CampaignResult result = RunCampaign(*scenario, options.campaign, [&](size_t done, size_t failed) {
      if (!terminal || (done % 20 != 0 && done != options.campaign.trials)) return;
      std::fprintf(stderr, "\r%zu of %zu trials, %zu with a violation ", done, options.campaign.trials,
                   failed);
      if (done == options.campaign.trials) std::fputc('\n', stderr);
    });
    Print(options.campaign, result);
    std::string error;
    const std::string json = (fs::path(options.campaign.directory) / "campaign.json").string();
    if (!WriteJson(ToJson(*scenario, options.campaign, result), json, &error))
      return Fail(error, kExitFailed);
    return result.failed.empty() ? kExitOk : kExitFailed;
  } catch (const std::system_error& error) {
    return Fail(error.what(), kExitFailed);
  }
}

}  // namespace

void AddCampaignCommand(Command* app, int* code) {
  auto options = std::make_shared<Options>();
  Command* command = app->add_subcommand(
      "campaign", "random faults, single and in pairs, in virtual time, each run watched by a judge");
  options->scenario.scenario = "hil/scenarios/campaign.toml";
  options->scenario.AddTo(command);
  command->get_option("SCENARIO")->required(false)->capture_default_str();
  options->campaign.directory = "out/campaign";
  Option* trials = command->add_option("--trials", options->campaign.trials, "number of trials");
  trials->range(1, 100'000'000)->capture_default_str();
  command
      ->add_option("--seed", options->campaign.first_seed,
                   "of the first trial; each further one has the next")
      ->capture_default_str();
  command->add_option("--jobs", options->campaign.jobs, "processes at once; 0: all cores")
      ->capture_default_str();
  command->add_flag("--replay", options->campaign.replay,
                    "judge the scenario with its own faults, instead of drawing some; one trial by default");
  command
      ->add_option("--out", options->campaign.directory,
                   "directory for campaign.json and the smallest scripts of trials that fail")
      ->capture_default_str();
  command->callback([=] {
    if (options->campaign.replay && trials->count() == 0) options->campaign.trials = 1;
    *code = Run(*options);
  });
}

}  // namespace armada
