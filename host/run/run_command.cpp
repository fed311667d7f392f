#include "host/run/run_command.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "firmware/app/exit_codes.h"
#include "firmware/app/initial_state.h"
#include "firmware/can/bus_name.h"
#include "firmware/clock/machine_clock.h"
#include "hil/live_faults.h"
#include "hil/scenario_file.h"
#include "hil/start_state.h"
#include "host/arm_table.h"
#include "host/private_network.h"
#include "host/process_group.h"
#include "host/run/board_lateness.h"
#include "host/run/board_networks.h"
#include "host/run/heartbeat.h"
#include "host/run/lcm_log.h"
#include "host/run/process_faults.h"
#include "host/run/run_buses.h"
#include "host/run/run_diagnosis.h"
#include "host/run/run_folder.h"
#include "host/run/run_in_vm.h"
#include "host/run/run_recorder.h"
#include "host/run/run_reservation.h"
#include "host/run/run_result.h"
#include "host/run/stepped_time.h"
#include "host/run/virtual_can.h"

namespace armada {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr int64_t kStartUpNs = 2'000'000'000;  // processes, sockets and drives are up well before
constexpr double kOverrun_s = 5.0;             // a program that has not ended by then is stuck
constexpr int64_t kMoment_ns = 5'000'000;      // between two looks at what goes on

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
      : options_(options), scenario_(std::move(scenario)), out_(options.out), clock_(MachineClock::Get()) {}

  bool Prepare(std::string* error);
  bool Execute(std::string* error);
  bool Collect(RunMetrics* metrics, nlohmann::ordered_json* json, std::string* error);
  /// Of a run that broke off; empty where it had not begun.
  std::vector<RunFinding> DiagnoseEnd(const std::string& why) const;
  bool interrupted() const { return interrupted_; }
  const std::vector<RunFinding>& findings() const { return findings_; }

 private:
  bool MakeKey(std::string* error);
  bool WriteInputs(std::string* error);
  bool MakeNetworks(std::string* error);
  bool MakeBoardNetworks(std::string* error);
  bool EnterOwnNetwork(const std::string& why, const std::vector<std::string>& interfaces,
                       std::string* error);
  bool StartAll(ProcessGroup* group, std::string* error);
  bool StartBoard(int arm_id, bool anew, ProcessGroup* group, std::string* error);
  std::map<int, std::string> BoardInterfaces() const;
  bool Start(ProcessGroup* group, const std::string& name, std::vector<std::string> argv, std::string* error);
  /// Words of a program's command line that say whose time it takes.
  std::vector<std::string> ClockArguments(const std::string& program);
  int ClockDescriptor() const { return stepped_ ? stepped_->descriptor() : -1; }
  bool OpenLcmLog(ProcessGroup* group, std::string* error);
  bool Watch(ProcessGroup* group, std::string* error);
  std::optional<ProcessExit> Pass(ProcessGroup* group);
  void TakeMessages();
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
  RunReservation reservation_;
  VirtualCan virtual_can_;                // before what uses it: removed last
  std::unique_ptr<SteppedTime> stepped_;  ///< null: the machine's time
  Clock* clock_;
  FleetKey key_{};
  int64_t epoch_ns_ = 0;
  std::unique_ptr<LcmEndpoint> link_;
  std::unique_ptr<RunRecorder> recorder_;
  std::unique_ptr<LcmLog> lcm_log_;  ///< stepped time; in the machine's lcm-logger writes it
  std::unique_ptr<ProgramControl> control_;
  std::optional<ProcessFaults> faults_;
  std::unique_ptr<LiveFaults> live_faults_;
  std::optional<Heartbeat> heartbeat_;
  double started_s_ = -1e-9 * static_cast<double>(kStartUpNs);  ///< when every program was; time of the run
  double ended_s_ = 0.0;
  std::vector<RunFinding> findings_;
  size_t running_ = 0;  ///< programs whose end is awaited
  bool interrupted_ = false;
};

// A run has a key of its own, whatever the fleet's: boards of the real fleet do not believe an emulated one.
bool Run::MakeKey(std::string* error) {
  std::string& file = scenario_.fleet.link.key_file;
  file = fs::absolute(In("fleet.key")).string();
  const bool made =
      stepped_ ? WriteFleetKey(file, SeededKey(options_.seed), error) : MakeFleetKey(file, error);
  if (!made) return false;
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
  if (options_.time == "stepped") {
    stepped_ = SteppedTime::Create(options_.pace, error);
    if (!stepped_) return false;
    clock_ = stepped_.get();
  }
  const auto url = ParseLcmUrl(scenario_.fleet.link.lcm_url, error);
  link_ = url ? LcmEndpoint::Open(*url, clock_, error) : nullptr;
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

// Interfaces that are there would be out of reach in a network of our own, and so would other boards.
bool Run::EnterOwnNetwork(const std::string& why, const std::vector<std::string>& interfaces,
                          std::string* error) {
  const auto url = ParseLcmUrl(scenario_.fleet.link.lcm_url, error);
  const bool bound = std::any_of(interfaces.begin(), interfaces.end(), VirtualCan::Exists);
  if (bound) {
    *error = why + ", and the CAN interfaces are of this network";
  } else if (url->ttl > 0) {
    *error =
        why + ", and link.lcm_url has ttl=" + std::to_string(url->ttl) + ": other boards could not be heard";
  } else if (EnterPrivateNetwork(error)) {
    std::cout << why << ": running in a private network namespace\n";
    return true;
  } else {
    *error = why + ", and " + *error;
  }
  return false;
}

bool Run::MakeNetworks(std::string* error) {
  if (options_.namespaces) return MakeBoardNetworks(error);
  const auto url = ParseLcmUrl(scenario_.fleet.link.lcm_url, error);
  if (!url) return false;
  const std::vector<std::string> interfaces = SocketCanInterfaces(scenario_.fleet, options_.hil_buses);
  const std::vector<std::string> wanted = NamesToReserve(scenario_.fleet, options_.hil_buses);
  // As fast as it goes nobody could follow anyway, and strangers would be heard.
  if (options_.time == "stepped" && options_.pace == 0.0 && EnterPrivateNetwork(error)) return true;
  error->clear();
  if (std::string taken; !HasMulticastRoute()) {
    if (!EnterOwnNetwork("no multicast route here", interfaces, error)) {
      error->append("; add a route: ip link set dev lo multicast on; ip route add 224.0.0.0/4 dev ");
      error->append(url->ttl > 0 ? "<interface>" : "lo");
      return false;
    }
  } else if (!reservation_.Take(wanted, &taken) && !EnterOwnNetwork(taken, interfaces, error)) {
    error->append("; wait for its end, or give this run other buses and another link.lcm_url");
    return false;
  }
  if (!virtual_can_.Provide(interfaces, error)) return false;
  if (!interfaces.empty()) PrintCanInterfaces(interfaces, virtual_can_.made(), std::cout);
  return true;
}

bool Run::Start(ProcessGroup* group, const std::string& name, std::vector<std::string> argv,
                std::string* error) {
  std::string log_name = name;
  for (char& c : log_name) c = c == ' ' ? '_' : c;
  return group->Start({name, std::move(argv), {}, In(log_name + ".txt"), ClockDescriptor()}, error);
}

std::vector<std::string> Run::ClockArguments(const std::string& program) {
  return stepped_ ? stepped_->ArgumentsFor(program) : std::vector<std::string>{};
}

bool Run::OpenLcmLog(ProcessGroup* group, std::string* error) {
  if (stepped_) {
    lcm_log_ = LcmLog::Create(In("lcm.log"), error);
    return lcm_log_ != nullptr;
  }
  return Start(group, "lcm-logger",
               {"/usr/bin/lcm-logger", "--quiet", "--force", "--lcm-url=" + scenario_.fleet.link.lcm_url,
                In("lcm.log")},
               error);
}

bool Run::StartAll(ProcessGroup* group, std::string* error) {
  epoch_ns_ = clock_->Now() + kStartUpNs;
  recorder_ = std::make_unique<RunRecorder>(scenario_, epoch_ns_, key_);
  const std::string epoch = std::to_string(epoch_ns_);
  if (!OpenLcmLog(group, error)) return false;
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
  const auto stepped = ClockArguments("hil");
  hil.insert(hil.end(), stepped.begin(), stepped.end());
  if (!Start(group, "hil", std::move(hil), error)) return false;
  for (const ArmEntry& arm : scenario_.fleet.arms) {
    if (!StartBoard(arm.id, false, group, error)) return false;
  }
  if (scenario_.leader.kind != LeaderKind::kNone) {
    std::vector<std::string> leader = {Program("armada-leader"),
                                       In("scenario.toml"),
                                       "--epoch-ns",
                                       epoch,
                                       "--seconds",
                                       Seconds(),
                                       "--state",
                                       In("state")};
    const auto of_time = ClockArguments(ProcessFaults::kLeaderProcess);
    leader.insert(leader.end(), of_time.begin(), of_time.end());
    if (!Start(group, ProcessFaults::kLeaderProcess, std::move(leader), error)) return false;
  }
  if (stepped_ && !stepped_->AwaitPrograms(group, error)) return false;
  if (stepped_) {
    control_ = std::make_unique<SteppedControl>(stepped_.get(), group);
  } else {
    control_ = std::make_unique<SignalControl>(group);
  }
  started_s_ = 1e-9 * static_cast<double>(clock_->Now() - epoch_ns_);
  running_ = scenario_.fleet.arms.size() + 1 + (scenario_.leader.kind == LeaderKind::kNone ? 0 : 1);
  faults_.emplace(scenario_.faults, BoardInterfaces(), clock_, epoch_ns_,
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
  const std::string name = ProcessFaults::ArmProcess(arm_id);
  const auto stepped = ClockArguments(name);
  board.insert(board.end(), stepped.begin(), stepped.end());
  const std::string log = In("arm_" + id + (anew ? "_anew" : "") + ".txt");
  return group->Start({name, std::move(board), {}, log, ClockDescriptor()}, error) &&
         (!anew || !stepped_ || stepped_->AwaitPrograms(group, error));
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
  const double t_s = 1e-9 * static_cast<double>(clock_->Now() - epoch_ns_);
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
  const double now_s = 1e-9 * static_cast<double>(clock_->Now() - epoch_ns_);
  while (const auto fault = live_faults_->Take(now_s)) faults_->Add(*fault);
}

bool Run::MakeFaults(ProcessGroup* group, std::string* error) {
  return faults_->MakeDue(
      control_.get(),
      [&](int arm_id, std::string* why) {
        ++running_;
        return StartBoard(arm_id, true, group, why);
      },
      error);
}

// Time goes on, for a moment. Returns a program that has ended, if one has.
std::optional<ProcessExit> Run::Pass(ProcessGroup* group) {
  const int64_t now_ns = clock_->Now();
  const int64_t until_ns = std::clamp(faults_->Next(), now_ns, now_ns + kMoment_ns);
  if (!stepped_) return group->Poll(nanoseconds(until_ns - now_ns));
  pollfd input{link_->descriptor(), POLLIN, 0};
  return stepped_->Pass(group, {&input, 1}, until_ns);
}

void Run::TakeMessages() {
  link_->Drain([&](const LcmMessage& message) {
    recorder_->OnMessage(message);
    if (lcm_log_) lcm_log_->Write(message, message.arrival_ns + clock_->WallNow() - clock_->Now());
  });
}

bool Run::Watch(ProcessGroup* group, std::string* error) {
  const int64_t end_ns = epoch_ns_ + static_cast<int64_t>((scenario_.seconds + kOverrun_s) * 1e9);
  // The last message of the leader is one period before the end.
  const double last_period_s = std::max(scenario_.fleet.timing.period_s, 1.0 / scenario_.leader.rate_hz);
  const int64_t earliest_end_ns =
      epoch_ns_ + static_cast<int64_t>((scenario_.seconds - last_period_s) * 1e9) - kMoment_ns;
  const int64_t progress_every_ns = isatty(STDOUT_FILENO) != 0 ? 200'000'000 : 5'000'000'000;
  int64_t next_progress_ns = 0;
  while (running_ > faults_->stopped_for_good()) {
    const auto ended = Pass(group);
    TakeMessages();
    TakeLiveFaults();
    if (!MakeFaults(group, error)) return false;
    if (ended) {
      const bool ordered = faults_->TakeOrdered(*ended);
      if (ended->Succeeded() && !ordered && clock_->Now() < earliest_end_ns) {
        *error = ended->name + " (pid " + std::to_string(ended->pid) +
                 ") ended before the run did: a signal has stopped it";
        return false;
      }
      const bool well = ended->Succeeded() || ordered || FinishedItsRun(*ended);
      if (!well || ended->name == "lcm-logger") {
        *error =
            (ended->name == "lcm-logger" ? In("lcm.log") + " is not complete: " : "") + ended->Describe();
        return false;
      }
      --running_;
    }
    if (stepped_ && !stepped_->trouble().empty()) {
      *error = stepped_->trouble();
      return false;
    }
    if (ProcessGroup::StopRequested()) {
      interrupted_ = true;
      *error = "interrupted; everything is stopped";
      return false;
    }
    if (clock_->Now() > end_ns) {
      *error = "a program is still running " + std::to_string(kOverrun_s) + " s after the end";
      return false;
    }
    if (const int64_t now_ns = MachineClock::Get()->Now(); now_ns >= next_progress_ns) {
      ShowProgress();
      next_progress_ns = now_ns + progress_every_ns;
    }
  }
  std::printf("\n");
  return true;
}

bool Run::Execute(std::string* error) {
  ProcessGroup group;
  if (!stepped_) heartbeat_.emplace(static_cast<int64_t>(TolerableLateness_s(scenario_.fleet.timing) * 1e9));
  const bool done = StartAll(&group, error) && Watch(&group, error);
  if (!done && ProcessGroup::StopRequested()) interrupted_ = true;
  if (heartbeat_) heartbeat_->Stop();
  ended_s_ = 1e-9 * static_cast<double>(clock_->Now() - epoch_ns_);
  if (faults_) faults_->KillStopped(control_.get());
  if (stepped_) stepped_->Release();
  group.StopAll(milliseconds(2000));
  return done;
}

bool Run::Collect(RunMetrics* metrics, nlohmann::ordered_json* json, std::string* error) {
  if (!recorder_->EveryArmHeard()) {
    *error = "not every arm was heard on " + scenario_.fleet.link.lcm_url;
    return false;
  }
  if (lcm_log_ && !lcm_log_->Close(error)) return false;
  if (stepped_ && stepped_->lost() > 0) {
    *error =
        std::to_string(stepped_->lost()) +
        " datagrams were sent and never arrived: this machine's network cannot carry a run in stepped time";
    return false;
  }
  if (!recorder_->WriteTraces(out_.string(), !stepped_, error)) return false;
  if (!CollectRunResult(scenario_, options_.seed, *recorder_, *faults_, out_.string(), metrics, json, error))
    return false;
  (*json)["time"] = options_.time;
  if (stepped_) {
    (*json)["stepped"] = {{"stepped_s", stepped_->stepped_s()},
                          {"datagrams_dropped", stepped_->dropped()},
                          {"timing",
                           {{"pace", options_.pace},
                            {"real_s", stepped_->real_s()},
                            {"datagrams_late", stepped_->late()},
                            {"datagrams_of_strangers", stepped_->strangers()}}}};
  }
  RunEvidence evidence = GatherEvidence(scenario_, options_.seed, epoch_ns_, *recorder_, &*faults_,
                                        heartbeat_ ? &*heartbeat_ : nullptr, out_.string());
  evidence.metrics = metrics;
  findings_ = Diagnose(evidence);
  (*json)["diagnosis"] = ToJson(findings_);
  if (!WriteJson(*json, In("metrics.json"), error)) return false;
  return options_.json.empty() || WriteJson(*json, options_.json, error);
}

std::vector<RunFinding> Run::DiagnoseEnd(const std::string& why) const {
  if (recorder_ == nullptr || interrupted_) return {};
  RunEvidence evidence =
      GatherEvidence(scenario_, options_.seed, epoch_ns_, *recorder_, faults_ ? &*faults_ : nullptr,
                     heartbeat_ ? &*heartbeat_ : nullptr, out_.string());
  evidence.started_s = started_s_;
  evidence.broke_off = why;
  evidence.broke_off_s = ended_s_;
  return Diagnose(evidence);
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
    return PrepareFolder(options.out, &error) ? RunInVm(options, *scenario) : Fail(error);
  }
  std::cout << scenario->name << ": " << scenario->fleet.arms.size() << " arms, " << scenario->seconds
            << " s, seed " << options.seed << ", into " << options.out << std::endl;
  Run run(options, std::move(*scenario));
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
