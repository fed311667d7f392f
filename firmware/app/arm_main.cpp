// armada-arm: the controller process of one arm.

#include <csignal>
#include <cstdio>
#include <iostream>
#include <limits>
#include <memory>

#include "firmware/app/arm_loop.h"
#include "firmware/app/command_line.h"
#include "firmware/app/config/fleet_file.h"
#include "firmware/app/exit_codes.h"
#include "firmware/app/heap_counter.h"
#include "firmware/app/initial_state.h"
#include "firmware/app/link_identity.h"
#include "firmware/app/loop_report.h"
#include "firmware/app/program_clock.h"
#include "firmware/app/realtime.h"
#include "firmware/app/standard_files.h"
#include "firmware/app/whole_file.h"
#include "firmware/can/open_bus.h"

namespace armada {
namespace {

volatile std::sig_atomic_t stop_requested = 0;

void RequestStop(int) {
  stop_requested = 1;
}

void StopOnSignals() {
  struct sigaction action {};
  action.sa_handler = RequestStop;  // no SA_RESTART: sleeps end
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

struct Options {
  std::string fleet;
  int arm_id = 0;
  int64_t epoch_ns = 0;
  double seconds = 0.0;
  std::string initial;
  std::string learned;
  std::string state = DefaultStateFolder();
  std::string json;
  std::string stepped_clock;
  int priority = 80;
  bool running = false;
};

int Fail(const Options& options, const std::string& message) {
  std::fprintf(stderr, "armada-arm %d: %s\n", options.arm_id, message.c_str());
  return kExitFailed;
}

int Run(const Options& options) {
  std::vector<ConfigError> errors;
  const auto fleet = LoadFleet(options.fleet, {}, &errors);
  if (!fleet) {
    PrintErrors(errors, std::cerr);
    return kExitBadConfig;
  }
  const int index = fleet->IndexOf(options.arm_id);
  if (index < 0) {
    std::fprintf(stderr, "armada-arm: --arm %d: %s has no such arm\n", options.arm_id, options.fleet.c_str());
    return kExitUsage;
  }
  const ArmEntry& entry = fleet->arms[static_cast<size_t>(index)];
  const auto initial = options.initial.empty() ? NominalInitialState(entry)
                                               : LoadInitialState(options.initial, entry, &errors);
  if (!initial) {
    PrintErrors(errors, std::cerr);
    return kExitBadConfig;
  }

  std::string error;
  if (!options.learned.empty() && !CanWriteWhole(options.learned, &error)) return Fail(options, error);
  std::optional<LinkIdentity> identity;
  if (!TakeIdentity(fleet->link, options.arm_id, options.state, &identity, &error)) {
    std::fprintf(stderr, "armada-arm %d: %s\n", options.arm_id, error.c_str());
    return kExitBadConfig;
  }
  if (!identity) std::fprintf(stderr, "armada-arm %d: %s\n", options.arm_id, WarningOf(fleet->link).c_str());
  const bool stepped = !options.stepped_clock.empty();
  const auto url = ParseLcmUrl(fleet->link.lcm_url, &error);
  if (!url) return Fail(options, error);
  if (!stepped) error = WhyNotReal(identity, fleet->link);
  const auto clock =
      error.empty() ? OpenProgramClock(options.stepped_clock, *url, {entry.bus}, &error) : nullptr;
  if (!clock) {
    std::fprintf(stderr, "armada-arm %d: %s\n", options.arm_id, error.c_str());
    return kExitBadConfig;
  }
  const auto link = LcmEndpoint::Open(*url, clock.get(), &error);
  if (!link) return Fail(options, error);
  const auto bus = OpenBus(entry.bus, BusOptionsOf(entry), clock.get(), &error);
  if (!bus) return Fail(options, error);

  const RealtimeGrant grant = stepped ? RealtimeGrant{} : EnterRealtime(options.priority);
  if (!grant.complaint.empty())
    std::fprintf(stderr, "armada-arm %d: %s\n", options.arm_id, grant.complaint.c_str());
  StopOnSignals();

  const int64_t epoch_ns = options.epoch_ns > 0
                               ? options.epoch_ns
                               : clock->Now() + static_cast<int64_t>(fleet->timing.bring_up_s * 1e9);
  const int64_t end_ns = options.seconds > 0.0 ? epoch_ns + static_cast<int64_t>(options.seconds * 1e9)
                                               : std::numeric_limits<int64_t>::max();
  const BoardStart start{options.running ? StartMode::kRunning : StartMode::kMonitor, FleetDigest(*fleet),
                         identity};
  const auto node = std::make_unique<ArmNode>(*fleet, static_cast<size_t>(index), *initial, epoch_ns, start);
  const auto loop =
      std::make_unique<ArmLoop>(node.get(), bus.get(), link.get(), clock.get(), fleet->timing, epoch_ns);
  if (options.running && !loop->BringUp(&stop_requested)) {
    return Fail(options, stop_requested != 0
                             ? "stopped before the start"
                             : "not every drive on " + entry.bus +
                                   " reached torque mode before the start: " + node->ExplainDrives());
  }
  const bool ended = loop->Run(end_ns, &stop_requested);
  if (!stepped) LeaveRealtime();

  const ControllerState state = loop->final_state();
  const bool stands = state == ControllerState::kFault || state == ControllerState::kSafeStop;
  if (!stands && !options.learned.empty() &&
      !WriteInitialState(WarmStart(entry, node->controller()), entry, options.learned, &error)) {
    return Fail(options, error);
  }
  // The report comes last: where it is, the board has done all that it was to do.
  const auto report = [&](std::ostream& file) { WriteLoopReport(*loop, *node, *bus, *link, grant, file); };
  if (!options.json.empty() && !WriteWhole(options.json, report, &error)) return Fail(options, error);
  if (!ended && options.seconds > 0.0) return kExitInterrupted;
  if (stands) return Fail(options, std::string("ended in ") + NameOf(state) + ": " + NameOf(node->cause()));
  return kExitOk;
}

}  // namespace
}  // namespace armada

int main(int argc, char** argv) {
  armada::OpenStandardFiles();
  armada::Options options;
  armada::CommandLine app(
      "Controller of one arm of a fleet: 100 Hz, fixed memory. It comes up in MONITOR, with its drives off, "
      "and moves the arm after `armada ctl arm` and `armada ctl start`.",
      "armada-arm");
  app.add_option("FLEET", options.fleet, "fleet file (TOML)")->required();
  app.add_option("--arm", options.arm_id, "id of this board's arm")->required();
  app.add_option("--epoch-ns", options.epoch_ns,
                 "fleet's time 0 on CLOCK_MONOTONIC, ns; default: timing.bring_up_s from now");
  app.add_option("--seconds", options.seconds, "length of the run; default: until SIGINT or SIGTERM");
  app.add_option("--initial", options.initial,
                 "file with zeta(0) and theta_hat(0), or what an earlier run has learnt; default: nominal");
  app.add_option("--learned", options.learned,
                 "write what the arm learns of its dynamics here, at the end of a run without a fault");
  app.add_option("--state", options.state, "folder for what must survive restarts: the number of starts")
      ->capture_default_str();
  app.add_flag("--running", options.running,
               "emulated arms only: enable the drives before the fleet's time 0, and run from there on. "
               "HAZARD: no operator is asked");
  app.add_option("--json", options.json, "write timing, memory and bus figures here at the end");
  app.add_option("--stepped-clock", options.stepped_clock, armada::kSteppedClockHelp);
  app.add_option("--priority", options.priority, "SCHED_FIFO priority; 0 asks for none")->range(0, 99);
  if (const auto code = app.parse(argc, argv)) return *code;
  return armada::Run(options);
}
