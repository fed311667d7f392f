// armada: the command line of the fleet.

#include <cstdio>
#include <filesystem>
#include <iostream>

#include "firmware/app/command_line.h"
#include "firmware/app/exit_codes.h"
#include "firmware/app/standard_files.h"
#include "hil/scenario_file.h"
#include "host/ablate/ablate_command.h"
#include "host/campaign/campaign_command.h"
#include "host/can/can_command.h"
#include "host/check.h"
#include "host/ctl/ctl_command.h"
#include "host/fault/fault_command.h"
#include "host/fault/storm_command.h"
#include "host/fleet/fleet_command.h"
#include "host/floor/floor_command.h"
#include "host/key_command.h"
#include "host/report_command.h"
#include "host/run/run_command.h"
#include "host/sim/sim_command.h"
#include "host/spy/spy_command.h"
#include "host/states_reference.h"
#include "host/sweep/sweep_command.h"

namespace {

std::string ProgramDirectory() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path().string();
}

// What was printed may wait in a buffer, and a disk may be full.
bool IsOutputWritten() {
  if (std::cout.flush() && std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return true;
  std::cerr << "armada: cannot write to standard output\n";
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace armada;
  OpenStandardFiles();
  CommandLine app("Armada: several different robot arms follow one moving leader in task space.", "armada");
  app.require_subcommand(1);
  int code = kExitOk;

  CheckOptions check;
  Command* check_command =
      app.add_subcommand("check", "validate a fleet or a scenario and print its margins");
  check_command->add_option("FILE", check.path, "fleet or scenario file")->required();
  check_command->add_option("--set", check.sets, "key=value: any parameter of the file")->take_all();
  auto* check_json = check_command->add_flag("--json", check.json, "print JSON");
  check_command
      ->add_option(
          "--explain", check.explain,
          "only the parameters whose keys have this in them: value, default, unit, range, meaning; . for "
          "all")
      ->excludes(check_json);
  check_command->callback([&] { code = RunCheck(check); });

  SimOptions sim;
  Command* sim_command = app.add_subcommand("sim", "run a scenario in virtual time");
  sim.scenario.AddTo(sim_command);
  sim_command->add_option("--seed", sim.seed, "seed of start states, disturbance and noise")
      ->capture_default_str();
  sim_command->add_option("--json", sim.json, "write metrics.json here");
  sim_command->add_option("--trace", sim.trace,
                          "write traces and metrics into this directory, for `armada report`");
  sim_command->add_flag("--floor", sim.floor, "the unavoidable error, too, and how far above it each arm is");
  sim_command->callback([&] { code = RunSimCommand(sim); });

  SweepOptions sweep;
  Command* sweep_command = app.add_subcommand("sweep", "run a scenario over many seeds, on all cores");
  std::vector<std::string> shards;
  std::string merged;
  Command* merge_command = sweep_command->add_subcommand("merge", "join the results of shards");
  merge_command->add_option("FILES", shards, "results written by `armada sweep --json`")->required();
  merge_command->add_option("--json", merged, "write the joint result here");
  merge_command->callback([&] { code = RunSweepMergeCommand(shards, merged); });
  sweep.scenario.AddTo(sweep_command);
  sweep_command->get_option("SCENARIO")->required(false);
  sweep_command->add_option("--seeds", sweep.seeds, "A:B, both included")->capture_default_str();
  sweep_command->add_option("--jobs", sweep.jobs, "threads; 0: all cores")->capture_default_str();
  sweep_command->add_option("--shard", sweep.shard, "I/N: every N-th seed from the I-th")
      ->capture_default_str();
  sweep_command->add_option("--json", sweep.json, "write the result here, every seed included");
  sweep_command->add_flag("--floor", sweep.floor,
                          "the unavoidable error, too, and how far above it each arm is");
  sweep_command->callback([&] {
    if (!merge_command->parsed()) code = RunSweepCommand(sweep);
  });

  FloorOptions floor;
  Command* floor_command =
      app.add_subcommand("floor", "the error that no controller can avoid under a scenario's disturbance");
  floor.scenario.AddScenarioTo(floor_command);
  auto* floor_seed = floor_command->add_option("--seed", floor.seed, "seed of disturbance and noise");
  floor_seed->capture_default_str();
  floor_command->add_option("--seeds", floor.seeds, "A:B, both included, instead of one seed")
      ->excludes(floor_seed);
  floor_command->add_option("--jobs", floor.jobs, "threads; 0: all cores")->capture_default_str();
  floor_command->add_option("--json", floor.json, "write the result here, every seed included");
  floor_command->callback([&] { code = RunFloorCommand(floor); });

  AblateOptions ablate;
  Command* ablate_command =
      app.add_subcommand("ablate", "what each component earns: a scenario with one taken out at a time");
  ablate.scenario.AddTo(ablate_command);
  ablate_command->add_option("--seeds", ablate.seeds, "A:B, both included; the same for every row")
      ->capture_default_str();
  ablate_command->add_option("--jobs", ablate.jobs, "threads; 0: all cores")->capture_default_str();
  ablate_command->add_option("--json", ablate.json, "write the table here");
  ablate_command->callback([&] { code = RunAblateCommand(ablate); });

  RunOptions run;
  run.program_directory = ProgramDirectory();
  Command* run_command = app.add_subcommand("run", "run a scenario as processes");
  run.scenario.AddTo(run_command);
  run_command
      ->add_option(
          "--bus", run.bus,
          "udp: the user-space CAN bus; socketcan: the kernel's CAN, missing interfaces are made; vm: the "
          "same in a virtual machine whose kernel has CAN")
      ->take_last()
      ->capture_default_str();
  run_command->add_flag("--namespaces", run.namespaces,
                        "socketcan, vm: each board in a network namespace of its own");
  run_command
      ->add_option("--hil-bus", run.hil_buses,
                   "ARM=BUS: the emulation's end of an arm's bus, where it has another name than the board's")
      ->allow_extra_args(false);
  run_command
      ->add_option("--time", run.time,
                   "real: the machine's time. stepped: time stands while a program computes or a message is "
                   "unread, so that a slow or busy machine changes nothing; --bus udp only")
      ->take_last()
      ->capture_default_str();
  run_command
      ->add_option("--pace", run.pace,
                   "--time stepped: seconds of the run a real second, 0.01 to 100; 0: as fast as it goes")
      ->take_last()
      ->capture_default_str();
  run_command->add_option("--seed", run.seed, "seed of start states, disturbance and noise")
      ->capture_default_str();
  run_command->add_option("--out", run.out, "directory for logs, traces and results")
      ->take_last()
      ->capture_default_str();
  run_command->add_option("--json", run.json, "write metrics.json here, too");
  run_command->callback([&] { code = RunRunCommand(run); });

  std::string report;
  Command* report_command = app.add_subcommand("report", "figures and a page of a finished run or sweep");
  report_command
      ->add_option("PATH", report,
                   "directory written by `armada run` or `armada sim --trace`; or what `armada sweep --json` "
                   "wrote, or "
                   "the directory of its sweep.json")
      ->required();
  report_command->callback([&] { code = RunReportCommand(report); });

  SpyOptions spy;
  Command* spy_command = app.add_subcommand("spy", "watch every message of a fleet in lcm-spy");
  auto* spy_file = spy_command->add_option("FILE", spy.file, "fleet or scenario file: its link.lcm_url");
  spy_command->add_option("--lcm-url", spy.lcm_url, "watch this LCM url")->excludes(spy_file);
  spy_command->add_flag("--jar-only", spy.jar_only, "make the jar of message types and print its path");
  spy_command->callback([&] { code = RunSpyCommand(spy); });

  AddCampaignCommand(&app, &code);
  AddCanCommand(&app, &code);
  AddCtlCommand(&app, &code);
  AddFleetCommand(&app, &code);
  AddKeyCommand(&app, &code);
  AddFaultCommand(&app, &code);
  AddStormCommand(&app, &code);

  app.add_subcommand("params", "print the reference of all parameters (docs/parameters.md)")->callback([] {
    WriteParameterReference(std::cout);
  });
  app.add_subcommand("states", "print the supervisor's states and causes (docs/states.md)")->callback([] {
    WriteStatesReference(std::cout);
  });

  if (const auto exit_code = app.parse(argc, argv)) return *exit_code;
  const bool written = IsOutputWritten();
  return code == kExitOk && !written ? kExitFailed : code;
}
