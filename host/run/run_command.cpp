#include "host/run/run_command.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "firmware/app/exit_codes.h"
#include "firmware/app/initial_state.h"
#include "firmware/app/realtime.h"
#include "firmware/can/bus_name.h"
#include "hil/live_faults.h"
#include "hil/scenario_file.h"
#include "hil/start_state.h"
#include "host/arm_table.h"
#include "host/private_network.h"
#include "host/process_group.h"
#include "host/run/board_networks.h"
#include "host/run/process_faults.h"
#include "host/run/run_buses.h"
#include "host/run/run_in_vm.h"
#include "host/run/run_recorder.h"
#include "host/run/run_result.h"
#include "host/run/virtual_can.h"

namespace armada {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr int64_t kStartUpNs = 2'000'000'000;  // processes, sockets and drives are up well before
constexpr double kOverrun_s = 5.0;             // a program that has not ended by then is stuck

int Fail(const std::string& message) {
  std::cerr << "armada run: " << message << '\n';
  return kExitFailed;
}

// An empty place for the run: what an earlier one left must not pass for a result of this one.
bool PrepareFolder(const fs::path& directory, std::string* error) {
  std::error_code code;
  fs::create_directories(directory, code);
  if (code) {
    *error = "cannot create " + directory.string() + ": " + code.message();
    return false;
  }
  std::error_code ignored;
  for (const char* name : {"metrics.json", "hil.json", "report.html", "timing.csv", "leader.csv", "lcm.log",
                           "report", "without_subtask", "fleet.key", "state"}) {
    fs::remove_all(directory / name, ignored);
  }
  for (const auto& entry : fs::directory_iterator(directory, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("arm_") || name.starts_with("can_") || name.starts_with("initial_"))
      fs::remove(entry.path(), ignored);
  }
  return true;
}

/// One run of a scenario as processes.
class Run {
 public:
  Run(const RunOptions& options, ScenarioConfig scenario)
      : options_(options), scenario_(std::move(scenario)), out_(options.out) {}

  bool Prepare(std::string* error);
  bool Execute(std::string* error);
  bool Collect(RunMetrics* metrics, nlohmann::ordered_json* json, std::string* error);
  bool interrupted() const { return interrupted_; }

 private:
  bool MakeKey(std::string* error);
  bool WriteInputs(std::string* error);
  bool MakeNetworks(std::string* error);
  bool MakeBoardNetworks(std::string* error);
  bool StartAll(ProcessGroup* group, std::string* error);
  bool StartBoard(int arm_id, bool anew, ProcessGroup* group, std::string* error);
  std::map<int, std::string> BoardInterfaces() const;
  bool Start(ProcessGroup* group, const std::string& name, std::vector<std::string> argv, std::string* error);
  bool Watch(ProcessGroup* group, std::string* error);
  bool FinishedItsRun(const ProcessExit& ended) const;
  bool MakeFaults(ProcessGroup* group, std::string* error);
  void TakeLiveFaults();
  void ShowProgress();
  std::string Program(const char* name) const {
    return (fs::path(options_.program_directory) / name).string();
  }
  std::string In(const std::string& name) const { return (out_ / name).string(); }
  std::string Seconds() const { return std::to_string(scenario_.seconds); }

  const RunOptions& options_;
  ScenarioConfig scenario_;
  fs::path out_;
  VirtualCan virtual_can_;  // before what uses it: removed last
  FleetKey key_{};
  int64_t epoch_ns_ = 0;
  std::unique_ptr<LcmEndpoint> link_;
  std::unique_ptr<RunRecorder> recorder_;
  std::optional<ProcessFaults> faults_;
  std::unique_ptr<LiveFaults> live_faults_;
  size_t running_ = 0;  ///< programs whose end is awaited
  bool interrupted_ = false;
};

// A run has a key of its own, whatever the fleet's: boards of the real fleet do not believe an emulated one.
bool Run::MakeKey(std::string* error) {
  std::string& file = scenario_.fleet.link.key_file;
  file = fs::absolute(In("fleet.key")).string();
  if (!MakeFleetKey(file, error)) return false;
  const auto key = LoadFleetKey(file, error);
  if (key) key_ = *key;
  return key.has_value();
}

bool Run::WriteInputs(std::string* error) {
  if (!PrepareFolder(out_, error)) return false;
  live_faults_ = LiveFaults::Create(out_.string(), LiveFaults::kOfProcesses, error);
  if (live_faults_ == nullptr) {
    std::cerr << "armada run: `armada fault` will not reach this run: " << *error << '\n';
    error->clear();
  }
  if (!MakeKey(error) || !WriteEffective(scenario_, out_.string(), error)) return false;
  std::optional<LeaderPath> leader;
  if (scenario_.leader.kind != LeaderKind::kNone) leader.emplace(scenario_.leader);
  for (size_t i = 0; i < scenario_.fleet.arms.size(); ++i) {
    const ArmStart start = DrawStart(scenario_, i, options_.seed, leader ? &*leader : nullptr);
    const std::string id = std::to_string(scenario_.fleet.arms[i].id);
    if (!WriteInitialState(start.controller, scenario_.fleet.arms[i], In("initial_" + id + ".toml"), error))
      return false;
  }
  return true;
}

bool Run::Prepare(std::string* error) {
  if (!MakeNetworks(error)) return false;
  const auto url = ParseLcmUrl(scenario_.fleet.link.lcm_url, error);
  link_ = url ? LcmEndpoint::Open(*url, error) : nullptr;
  return link_ != nullptr && WriteInputs(error);
}

// The boards' LCM leaves their namespaces: one hop at least.
bool Run::MakeBoardNetworks(std::string* error) {
  auto url = ParseLcmUrl(scenario_.fleet.link.lcm_url, error);
  if (!url) return false;
  url->ttl = std::max(url->ttl, 1);
  scenario_.fleet.link.lcm_url = ToString(*url);
  BoardNetworks networks;
  if (!networks.Enter(error)) return false;
  for (const ArmEntry& arm : scenario_.fleet.arms) {
    if (!networks.Add(arm.id, SocketCanInterface(arm.bus), error)) return false;
  }
  std::cout << "each board in a network namespace of its own, LCM on " << scenario_.fleet.link.lcm_url
            << '\n';
  return true;
}

bool Run::MakeNetworks(std::string* error) {
  if (options_.namespaces) return MakeBoardNetworks(error);
  const auto url = ParseLcmUrl(scenario_.fleet.link.lcm_url, error);
  if (!url) return false;
  const std::vector<std::string> interfaces = SocketCanInterfaces(scenario_.fleet, options_.hil_buses);
  if (!HasMulticastRoute()) {
    // Interfaces that are there would be out of reach in a network of our own, and so would other boards.
    const bool bound = std::any_of(interfaces.begin(), interfaces.end(), VirtualCan::Exists);
    if (url->ttl > 0 || bound) {
      *error =
          "no multicast route here, and " +
          (bound ? "the CAN interfaces are of this network"
                 : "link.lcm_url has ttl=" + std::to_string(url->ttl) + ": other boards could not be heard") +
          "; add a route: ip link set dev lo multicast on; ip route add 224.0.0.0/4 dev " +
          (url->ttl > 0 ? "<interface>" : "lo");
      return false;
    }
    if (!EnterPrivateNetwork(error)) return false;
    std::cout << "no multicast route here: running in a private network namespace\n";
  }
  if (!virtual_can_.Provide(interfaces, error)) return false;
  if (!interfaces.empty()) PrintCanInterfaces(interfaces, virtual_can_.made(), std::cout);
  return true;
}

bool Run::Start(ProcessGroup* group, const std::string& name, std::vector<std::string> argv,
                std::string* error) {
  std::string log_name = name;
  for (char& c : log_name) c = c == ' ' ? '_' : c;
  return group->Start({name, std::move(argv), {}, In(log_name + ".txt")}, error);
}

bool Run::StartAll(ProcessGroup* group, std::string* error) {
  epoch_ns_ = MonotonicNow() + kStartUpNs;
  recorder_ = std::make_unique<RunRecorder>(scenario_, epoch_ns_, key_);
  const std::string epoch = std::to_string(epoch_ns_);
  if (!Start(group, "lcm-logger",
             {"/usr/bin/lcm-logger", "--quiet", "--force", "--lcm-url=" + scenario_.fleet.link.lcm_url,
              In("lcm.log")},
             error)) {
    return false;
  }
  std::vector<std::string> hil = {Program("armada-hil"),
                                  In("scenario.toml"),
                                  "--seed",
                                  std::to_string(options_.seed),
                                  "--epoch-ns",
                                  epoch,
                                  "--seconds",
                                  Seconds(),
                                  "--out",
                                  out_.string()};
  for (const std::string& bus : options_.hil_buses) hil.insert(hil.end(), {"--bus", bus});
  if (!Start(group, "hil", std::move(hil), error)) return false;
  for (const ArmEntry& arm : scenario_.fleet.arms) {
    if (!StartBoard(arm.id, false, group, error)) return false;
  }
  if (scenario_.leader.kind != LeaderKind::kNone &&
      !Start(group, ProcessFaults::kLeaderProcess,
             {Program("armada-leader"), In("scenario.toml"), "--epoch-ns", epoch, "--seconds", Seconds(),
              "--state", In("state")},
             error)) {
    return false;
  }
  running_ = scenario_.fleet.arms.size() + 1 + (scenario_.leader.kind == LeaderKind::kNone ? 0 : 1);
  faults_.emplace(scenario_.faults, BoardInterfaces(), epoch_ns_,
                  epoch_ns_ + static_cast<int64_t>(scenario_.seconds * 1e9));
  return true;
}

// A board that starts anew comes up as one does that an operator has switched on: in MONITOR, drives off.
bool Run::StartBoard(int arm_id, bool anew, ProcessGroup* group, std::string* error) {
  const std::string id = std::to_string(arm_id);
  std::vector<std::string> board;
  if (options_.namespaces) board = BoardNetworks::Prefix(arm_id);
  board.insert(board.end(),
               {Program("armada-arm"), In("fleet.toml"), "--arm", id, "--epoch-ns", std::to_string(epoch_ns_),
                "--seconds", Seconds(), "--learned", LearnedFile(In("learned"), arm_id), "--state",
                In("state"), "--json", In("arm_" + id + ".json")});
  if (!anew) board.insert(board.end(), {"--initial", In("initial_" + id + ".toml")});
  if (!anew && scenario_.start.mode == StartMode::kRunning) board.emplace_back("--running");
  const std::string log = In("arm_" + id + (anew ? "_anew" : "") + ".txt");
  return group->Start({ProcessFaults::ArmProcess(arm_id), std::move(board), {}, log}, error);
}

// Where the emulation has another end of the bus, the board's can go down without it.
std::map<int, std::string> Run::BoardInterfaces() const {
  std::map<int, std::string> interfaces;
  for (const ArmEntry& arm : scenario_.fleet.arms) {
    const std::string own = SocketCanInterface(arm.bus);
    const bool apart =
        std::any_of(options_.hil_buses.begin(), options_.hil_buses.end(),
                    [&](const std::string& bus) { return bus.starts_with(std::to_string(arm.id) + "="); });
    if (apart && !own.empty()) interfaces[arm.id] = own;
  }
  return interfaces;
}

void Run::ShowProgress() {
  const double t_s = 1e-9 * static_cast<double>(MonotonicNow() - epoch_ns_);
  double worst_m = 0.0;
  int64_t missed = 0;
  size_t heard = 0;
  for (size_t i = 0; i < scenario_.fleet.arms.size(); ++i) {
    const auto& latest = recorder_->Latest(i);
    if (!latest) continue;
    ++heard;
    worst_m = std::max(worst_m, latest->error_m);
    missed += latest->missed_ticks;
  }
  if (t_s < 0.0) {
    std::printf("starting: %.1f s to go", -t_s);
  } else {
    std::printf("t %5.1f of %g s, %zu of %zu arms, largest |x - x_hat| %8.2f mm, missed ticks %lld", t_s,
                scenario_.seconds, heard, scenario_.fleet.arms.size(), worst_m * 1e3,
                static_cast<long long>(missed));
  }
  std::fputs(isatty(STDOUT_FILENO) != 0 ? "  \r" : "\n", stdout);
  std::fflush(stdout);
}

// A board that ended in FAULT exits with 1, but has done its run and reported: that is a result, not a crash.
bool Run::FinishedItsRun(const ProcessExit& ended) const {
  return std::any_of(scenario_.fleet.arms.begin(), scenario_.fleet.arms.end(), [&](const ArmEntry& arm) {
    return ended.name == ProcessFaults::ArmProcess(arm.id) &&
           fs::exists(out_ / ("arm_" + std::to_string(arm.id) + ".json"));
  });
}

void Run::TakeLiveFaults() {
  if (live_faults_ == nullptr) return;  // not every file system has pipes
  const double now_s = 1e-9 * static_cast<double>(MonotonicNow() - epoch_ns_);
  while (const auto fault = live_faults_->Take(now_s)) faults_->Add(*fault);
}

bool Run::MakeFaults(ProcessGroup* group, std::string* error) {
  return faults_->MakeDue(
      group,
      [&](int arm_id, std::string* why) {
        ++running_;
        return StartBoard(arm_id, true, group, why);
      },
      error);
}

bool Run::Watch(ProcessGroup* group, std::string* error) {
  const int64_t end_ns = epoch_ns_ + static_cast<int64_t>((scenario_.seconds + kOverrun_s) * 1e9);
  const int64_t progress_every_ns = isatty(STDOUT_FILENO) != 0 ? 200'000'000 : 5'000'000'000;
  int64_t next_progress_ns = 0;
  while (running_ > faults_->stopped_for_good()) {
    const auto ended = group->Poll(faults_->TimeLeft(milliseconds(5)));
    link_->Drain([&](const LcmMessage& message) { recorder_->OnMessage(message); });
    TakeLiveFaults();
    if (!MakeFaults(group, error)) return false;
    if (ended) {
      const bool well = ended->Succeeded() || faults_->TakeOrdered(*ended) || FinishedItsRun(*ended);
      if (!well || ended->name == "lcm-logger") {
        *error = ended->Describe();
        return false;
      }
      --running_;
    }
    if (ProcessGroup::StopRequested()) {
      interrupted_ = true;
      *error = "interrupted; everything is stopped";
      return false;
    }
    const int64_t now_ns = MonotonicNow();
    if (now_ns > end_ns) {
      *error = "a program is still running " + std::to_string(kOverrun_s) + " s after the end";
      return false;
    }
    if (now_ns >= next_progress_ns) {
      ShowProgress();
      next_progress_ns = now_ns + progress_every_ns;
    }
  }
  std::printf("\n");
  return true;
}

bool Run::Execute(std::string* error) {
  ProcessGroup group;
  const bool done = StartAll(&group, error) && Watch(&group, error);
  if (faults_) faults_->KillStopped(&group);
  group.StopAll(milliseconds(2000));
  return done;
}

bool Run::Collect(RunMetrics* metrics, nlohmann::ordered_json* json, std::string* error) {
  if (!recorder_->EveryArmHeard()) {
    *error = "not every arm was heard on " + scenario_.fleet.link.lcm_url;
    return false;
  }
  if (!recorder_->WriteTraces(out_.string(), error)) return false;
  if (!CollectRunResult(scenario_, options_.seed, *recorder_, *faults_, out_.string(), metrics, json, error))
    return false;
  if (!WriteJson(*json, In("metrics.json"), error)) return false;
  return options_.json.empty() || WriteJson(*json, options_.json, error);
}

}  // namespace

int RunRunCommand(const RunOptions& options) {
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
  std::string error;
  if (options.bus == "vm") {
    return PrepareFolder(options.out, &error) ? RunInVm(options, *scenario) : Fail(error);
  }
  std::cout << scenario->name << ": " << scenario->fleet.arms.size() << " arms, " << scenario->seconds
            << " s, seed " << options.seed << ", into " << options.out << std::endl;
  Run run(options, std::move(*scenario));
  RunMetrics metrics;
  nlohmann::ordered_json json;
  if (!run.Prepare(&error) || !run.Execute(&error) || !run.Collect(&metrics, &json, &error)) {
    const int code = Fail(error);
    return run.interrupted() ? kExitInterrupted : code;
  }
  PrintArmTable(metrics, std::cout);
  PrintProcessTable(json, std::cout);
  return metrics.ok ? kExitOk : kExitFailed;
}

}  // namespace armada
