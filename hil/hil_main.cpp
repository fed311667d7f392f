// armada-hil: a scenario's arms and drives, emulated in real time on the fleet's buses.
//
// Exit codes: 0 ran to its end; 1 a bus or a file cannot be used; 2 usage; 78 bad configuration; 130 a signal
// stopped it.

#include <sys/prctl.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <iostream>

#include "firmware/app/command_line.h"
#include "firmware/app/exit_codes.h"
#include "firmware/app/heap_counter.h"
#include "firmware/app/program_clock.h"
#include "firmware/app/realtime.h"
#include "firmware/app/standard_files.h"
#include "firmware/can/open_bus.h"
#include "hil/active_drive.h"
#include "hil/fault_meaning.h"
#include "hil/hil_report.h"
#include "hil/hil_server.h"
#include "hil/poll_clock.h"
#include "hil/scenario_file.h"

namespace armada {
namespace {

constexpr int64_t kListenNs = 150'000'000;  // one and a half heartbeats
constexpr int64_t kStartUpNs = 1'000'000'000;
constexpr int64_t kLongestWaitNs = 3600 * kStartUpNs;  // beyond it the number is of another clock

struct Options {
  std::string scenario;
  std::vector<std::string> sets;
  std::vector<std::string> buses;  // <arm>=<bus>
  uint64_t seed = 1;
  int64_t epoch_ns = 0;  // 0: one second after the benches are switched on
  double seconds = 0.0;  // 0: the scenario's
  std::string out;
  std::string stepped_clock;
  int priority = 85;  // before the boards: hardware does not wait for its controller
};

using Buses = std::vector<std::unique_ptr<CanBus>>;
using Logs = std::vector<std::unique_ptr<CanLog>>;

int Fail(const std::string& message) {
  std::cerr << "armada-hil: " << message << '\n';
  return kExitFailed;
}

bool OpenBuses(const FleetConfig& fleet, Clock* clock, Buses* buses, std::string* error) {
  for (const ArmEntry& arm : fleet.arms) {
    BusOptions options = BusOptionsOf(arm);
    options.filters.clear();  // the logs show all that is on the bus
    buses->push_back(OpenBus(arm.bus, options, clock, error));
    if (buses->back() == nullptr) return false;
  }
  return true;
}

// The emulation's end of a bus may have another name than the board's, as with two cards in one computer.
bool RenameBuses(const std::vector<std::string>& assignments, FleetConfig* fleet, std::string* error) {
  for (const std::string& text : assignments) {
    const size_t sign = text.find('=');
    const auto arm = std::find_if(fleet->arms.begin(), fleet->arms.end(), [&](const ArmEntry& entry) {
      return std::to_string(entry.id) == text.substr(0, sign);
    });
    if (sign == std::string::npos || arm == fleet->arms.end()) {
      *error = "--bus " + text + ": must be <arm>=<bus> with an arm of the fleet, such as " +
               std::to_string(fleet->arms.front().id) + "=socketcan:can1";
      return false;
    }
    arm->bus = text.substr(sign + 1);
  }
  return true;
}

// From the monotonic clock to the wall clock. The two are read one after the other: the closest of some pairs
// counts.
int64_t WallOffset(const Clock& clock) {
  int64_t offset_ns = 0;
  int64_t closest_ns = kStartUpNs;
  for (int i = 0; i < 10; ++i) {
    const int64_t before_ns = clock.Now();
    const int64_t wall_ns = clock.WallNow();
    const int64_t apart_ns = clock.Now() - before_ns;
    if (apart_ns >= closest_ns) continue;
    closest_ns = apart_ns;
    offset_ns = wall_ns - before_ns - apart_ns / 2;
  }
  return offset_ns;
}

std::string LogPath(const std::string& directory, int arm_id) {
  return directory + "/can_" + std::to_string(arm_id) + ".log";
}

std::string BusDown(const std::string& bus, double t_s) {
  return "bus " + bus + " went down at " + std::to_string(t_s) + " s";
}

bool CreateLogs(const FleetConfig& fleet, const std::string& directory, int64_t wall_offset_ns, bool stepped,
                Logs* logs, std::string* error) {
  std::error_code code;
  std::filesystem::create_directories(directory, code);
  if (code) {
    *error = "cannot make " + directory + ": " + code.message();
    return false;
  }
  for (const ArmEntry& arm : fleet.arms) {
    const std::string channel = "can" + std::to_string(arm.id);
    logs->push_back(CanLog::Create(LogPath(directory, arm.id), channel, wall_offset_ns, error));
    if (logs->back() == nullptr) return false;
    if (stepped) logs->back()->WriteInTheLoop();
  }
  return true;
}

// The loop, and what it came to.
HilReport Serve(const ScenarioConfig& scenario, const Options& options, int64_t epoch_ns, const Buses& buses,
                const Logs& logs, LiveFaults* live, PollClock* clock) {
  std::vector<CanLog*> log_pointers;
  for (const auto& log : logs) log_pointers.push_back(log.get());
  const bool stepped = !options.stepped_clock.empty();
  std::optional<CanLogWriter> writer;
  if (!stepped) writer.emplace(log_pointers);  // before the priority is raised: it keeps the low one
  HilReport report;
  if (!stepped) report.grant = EnterRealtime(options.priority);
  if (!report.grant.complaint.empty()) std::cerr << "armada-hil: " << report.grant.complaint << '\n';
  prctl(PR_SET_TIMERSLACK, 1ul);  // without SCHED_FIFO the kernel would add up to 50 us to each wait

  HilServer server(scenario, options.seed, epoch_ns, buses, log_pointers, clock);
  server.TakeFaultsFrom(live);
  std::cout << "armada-hil: " << buses.size() << " arms on, seed " << options.seed << ", epoch " << epoch_ns
            << " ns" << std::endl;
  const uint64_t heap_before = HeapCounter::Allocations();
  const int64_t faults_before = PageFaults();
  report.end = server.Run(options.seconds > 0.0 ? options.seconds : scenario.seconds);
  if (stepped) std::for_each(logs.begin(), logs.end(), [](const auto& log) { log->WriteOut(); });
  if (HeapCounter::available()) report.heap_allocations = HeapCounter::Allocations() - heap_before;
  report.page_faults = PageFaults() - faults_before;
  report.scenario = scenario.name;
  report.seed = options.seed;
  report.epoch_ns = epoch_ns;
  report.seconds = std::max(0.0, server.time_s());
  report.arms = server.Results();
  report.pacing = server.pacing();
  report.latest_at_s = server.latest_at_s();
  report.faults_taken = server.faults_taken();
  return report;
}

// Faults of the link and of a board's inside are nobody's to make in real time; `armada run` makes those of
// processes.
void TellWhatIsLeftOut(const std::vector<FaultConfig>& faults) {
  for (const FaultConfig& fault : faults) {
    if (MeaningOf(fault.kind).maker != FaultMaker::kNobody) continue;
    std::cerr << "armada-hil: fault " << NameOf(fault.kind) << " at " << fault.at_s
              << " s is left out: it is of virtual time\n";
  }
}

int WriteResults(const HilReport& report, const Logs& logs, const std::string& directory) {
  std::string error;
  if (!WriteHilReport(report, logs, directory + "/hil.json", &error)) return Fail(error);
  for (const auto& log : logs) {
    if (!log->error().empty()) return Fail(log->error());
  }
  return kExitOk;
}

int Run(const Options& options) {
  std::vector<ConfigError> errors;
  auto scenario = LoadScenario(options.scenario, options.sets, &errors);
  if (!scenario) {
    PrintErrors(errors, std::cerr);
    return kExitBadConfig;
  }

  std::string error;
  if (!RenameBuses(options.buses, &scenario->fleet, &error)) {
    std::cerr << "armada-hil: " << error << '\n';
    return kExitUsage;
  }
  const auto url = ParseLcmUrl(scenario->fleet.link.lcm_url, &error);
  if (!url) return Fail(error);
  std::vector<std::string> bus_names;
  for (const ArmEntry& arm : scenario->fleet.arms) bus_names.push_back(arm.bus);
  const auto program_clock = OpenProgramClock(options.stepped_clock, *url, bus_names, &error);
  if (!program_clock) {
    std::cerr << "armada-hil: " << error << '\n';
    return kExitBadConfig;
  }
  Buses buses;
  if (!OpenBuses(scenario->fleet, program_clock.get(), &buses, &error)) return Fail(error);
  const auto clock = PollClock::Create(buses, program_clock.get(), &error);
  if (clock == nullptr) return Fail(error);
  if (const auto drive = FindActiveDrive(scenario->fleet, buses, kListenNs, clock.get())) {
    return Fail("bus " + scenario->fleet.arms[drive->bus].bus +
                ": another emulation or drive is already active (frames of node " +
                std::to_string(drive->node_id) + ")");
  }
  Logs logs;
  const int64_t wall_offset_ns = WallOffset(*program_clock);
  if (!options.out.empty() && !CreateLogs(scenario->fleet, options.out, wall_offset_ns,
                                          !options.stepped_clock.empty(), &logs, &error))
    return Fail(error);

  const int64_t now_ns = clock->Now();
  const int64_t epoch_ns = options.epoch_ns > 0 ? options.epoch_ns : now_ns + kStartUpNs;
  if (epoch_ns < now_ns || epoch_ns > now_ns + kLongestWaitNs) {
    std::cerr << "armada-hil: --epoch-ns " << epoch_ns << ": must be on CLOCK_MONOTONIC, which is at "
              << now_ns << ", and within the next hour\n";
    return kExitUsage;
  }
  TellWhatIsLeftOut(scenario->faults);
  std::unique_ptr<LiveFaults> live;
  if (!options.out.empty()) {
    live = LiveFaults::Create(options.out, LiveFaults::kOfEmulation, &error);
    if (live == nullptr) std::cerr << "armada-hil: `armada fault` will not reach this run: " << error << '\n';
  }
  HilReport report = Serve(*scenario, options, epoch_ns, buses, logs, live.get(), clock.get());
  report.epoch_wall_ns = epoch_ns + wall_offset_ns;
  const int code = options.out.empty() ? kExitOk : WriteResults(report, logs, options.out);
  for (const HilArmResult& arm : report.arms) {
    if (arm.bus_down) return Fail(BusDown(arm.bus, report.seconds));
  }
  return code == kExitOk && report.end == HilEnd::kStopped ? kExitInterrupted : code;
}

}  // namespace
}  // namespace armada

int main(int argc, char** argv) {
  armada::OpenStandardFiles();
  armada::Options options;
  armada::CommandLine app(
      "Emulates a scenario's arms and drives in real time, on the buses that its fleet names.", "armada-hil");
  app.add_option("SCENARIO", options.scenario, "scenario file (TOML)")->required();
  app.add_option("--seed", options.seed, "of start states, disturbances and sensor noise")->not_negative();
  app.add_option("--epoch-ns", options.epoch_ns,
                 "fleet's time 0 on CLOCK_MONOTONIC, ns; default: one second from now")
      ->positive();
  app.add_option("--seconds", options.seconds, "length of the run from the epoch; default: the scenario's")
      ->range(0.001, 1e6);
  app.add_option("--set", options.sets,
                 "key=value in place of the scenario's or the fleet's; may be repeated")
      ->allow_extra_args(false);
  app.add_option("--bus", options.buses,
                 "ARM=BUS: open this in place of the bus that the fleet names; may be repeated")
      ->allow_extra_args(false);
  app.add_option("--out", options.out, "directory for hil.json and can_<id>.log");
  app.add_option("--stepped-clock", options.stepped_clock, armada::kSteppedClockHelp);
  app.add_option("--priority", options.priority, "SCHED_FIFO priority; 0 asks for none")->range(0, 99);
  if (const auto code = app.parse(argc, argv)) return *code;
  return armada::Run(options);
}
