#include "host/fault/fault_command.h"

#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "firmware/app/command_line.h"
#include "firmware/app/config/value_text.h"
#include "firmware/app/exit_codes.h"
#include "hil/fault_meaning.h"
#include "hil/live_faults.h"
#include "hil/scenario_file.h"

namespace armada {
namespace {

struct Options {
  std::string directory = "out/run";
  std::string kind;
  int arm = 0;
  int joint = 0;
  std::string signal;
  std::string way;
  std::optional<double> value;
  double after_s = 0.2;  // what is to repeat or delay has something by then
  std::optional<double> for_s;
};

int Fail(const std::string& message, int code) {
  std::cerr << "armada fault: " << message << '\n';
  return code;
}

/// As it would stand in a scenario, its times from now on.
std::string TableOf(const Options& options) {
  std::string table = "{ kind = " + ValueText(options.kind) + ", at_s = " + ValueText(options.after_s) +
                      ", arm = " + ValueText(options.arm) + ", joint = " + ValueText(options.joint);
  if (options.for_s) table += ", until_s = " + ValueText(options.after_s + *options.for_s);
  if (!options.signal.empty()) table += ", signal = " + ValueText(options.signal);
  if (!options.way.empty()) table += ", way = " + ValueText(options.way);
  if (options.value) table += ", value = " + ValueText(*options.value);
  return table + " }";
}

int Send(const Options& options) {
  const std::string table = TableOf(options);
  std::vector<ConfigError> errors;
  // The rules of scenarios, on the scenario that runs.
  const auto scenario =
      LoadScenario(options.directory + "/scenario.toml", {"fault=[" + table + "]"}, &errors);
  if (!scenario) {
    PrintErrors(errors, std::cerr);
    return kExitBadConfig;
  }
  const FaultMaker maker = MeaningOf(scenario->faults.front().kind).maker;
  if (maker == FaultMaker::kNobody)
    return Fail(options.kind + " is of virtual time: put it into a scenario for `armada sim`", kExitUsage);
  const char* const pipe =
      maker == FaultMaker::kEmulation ? LiveFaults::kOfEmulation : LiveFaults::kOfProcesses;
  std::string error;
  if (!SendLiveFault(table, options.directory, pipe, &error)) return Fail(error, kExitFailed);
  std::cout << "from now on: " << table << '\n';
  return kExitOk;
}

}  // namespace

void AddFaultCommand(Command* app, int* code) {
  auto options = std::make_shared<Options>();
  Command* command = app->add_subcommand("fault", "a fault into a run that goes on, see docs/faults.md");
  command->add_option("KIND", options->kind, "kind of the fault")->required();
  command->add_option("--out", options->directory, "directory of the run, as given to `armada run --out`")
      ->capture_default_str();
  command->add_option("--arm", options->arm, "id of the arm; 0: the leader, or the computer");
  command->add_option("--joint", options->joint, "drive, drive_error: the joint, from 1; 0: every one");
  command->add_option("--signal", options->signal, "drive: position, velocity, status, current");
  command->add_option("--way", options->way,
                      "drive: off, stuck, garbage, wrong, slow, delayed, intermittent");
  command->add_option("--value", options->value, "how much");
  command->add_option("--after", options->after_s, "seconds until it begins")->capture_default_str();
  command->add_option("--for", options->for_s, "seconds that it lasts; default: for good");
  command->callback([=] { *code = Send(*options); });
}

}  // namespace armada
