#include "host/run/fleet_run.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

#include "firmware/app/exit_codes.h"
#include "firmware/app/initial_state.h"
#include "firmware/clock/machine_clock.h"
#include "hil/scenario_file.h"
#include "hil/start_state.h"
#include "host/run/board_lateness.h"
#include "host/run/run_buses.h"
#include "host/run/run_diagnosis.h"
#include "host/run/run_evidence.h"
#include "host/run/run_result.h"

namespace armada {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr int64_t kStartUpNs = 2'000'000'000;  // processes, sockets and drives are up well before
constexpr double kOverrun_s = 5.0;             // a program that has not ended by then is stuck
constexpr int64_t kMoment_ns = 5'000'000;      // between two looks at what goes on
constexpr int64_t kStood_ns = 200'000'000;     // between two looks: this process stood still
constexpr const char* kLogger = "lcm-logger";

bool HasLeader(const ScenarioConfig& scenario) {
  return scenario.leader.kind != LeaderKind::kNone;
}

// Boards whose CAN can go down without the emulation's: it has another end of the bus.
std::map<int, std::string> BoardInterfaces(const FleetConfig& fleet,
                                           const std::vector<std::string>& hil_buses) {
  std::map<int, std::string> interfaces;
  for (const ArmEntry& arm : fleet.arms) {
    const std::string own = SocketCanInterface(arm.bus);
    const bool apart = std::any_of(hil_buses.begin(), hil_buses.end(), [&](const std::string& bus) {
      return bus.starts_with(std::to_string(arm.id) + "=");
    });
    if (apart && !own.empty()) interfaces[arm.id] = own;
  }
  return interfaces;
}

}  // namespace

FleetRun::FleetRun(const RunOptions& options, const RunFolder& folder, ScenarioConfig scenario)
    : options_(options),
      folder_(folder),
      scenario_(std::move(scenario)),
      lines_(options_, scenario_),
      clock_(MachineClock::Get()),
      started_s_(-1e-9 * static_cast<double>(kStartUpNs)) {}

bool FleetRun::Prepare(std::string* error) {
  if (!networks_.Provide(options_, &scenario_.fleet, error)) return false;
  if (options_.time == "stepped") {
    stepped_ = SteppedTime::Create(options_.pace, error);
    if (!stepped_) return false;
    clock_ = stepped_.get();
  }
  const auto url = ParseLcmUrl(scenario_.fleet.link.lcm_url, error);
  link_ = url ? LcmEndpoint::Open(*url, clock_, error) : nullptr;
  return link_ != nullptr && WriteInputs(error);
}

bool FleetRun::WriteInputs(std::string* error) {
  EmptyRunFolder(options_.out);
  live_faults_ = LiveFaults::Create(options_.out, LiveFaults::kOfProcesses, error);
  if (live_faults_ == nullptr) {
    std::cerr << "armada run: `armada fault` will not reach this run: " << *error << '\n';
    error->clear();
  }
  if (!MakeKey(error) || !WriteEffective(scenario_, options_.out, error)) return false;
  std::optional<LeaderPath> leader;
  if (HasLeader(scenario_)) leader.emplace(scenario_.leader);
  for (size_t i = 0; i < scenario_.fleet.arms.size(); ++i) {
    const ArmStart start = DrawStart(scenario_, i, options_.seed, leader ? &*leader : nullptr);
    const std::string id = std::to_string(scenario_.fleet.arms[i].id);
    if (!WriteInitialState(start.controller, scenario_.fleet.arms[i], In("initial_" + id + ".toml"), error))
      return false;
  }
  return true;
}

// A run has a key of its own, whatever the fleet's: boards of the real fleet do not believe an emulated one.
bool FleetRun::MakeKey(std::string* error) {
  std::string& file = scenario_.fleet.link.key_file;
  file = fs::absolute(In("fleet.key")).string();
  const bool made =
      stepped_ ? WriteFleetKey(file, SeededKey(options_.seed), error) : MakeFleetKey(file, error);
  if (!made) return false;
  const auto key = LoadFleetKey(file, error);
  if (key) key_ = *key;
  return key.has_value();
}

bool FleetRun::Execute(std::string* error) {
  ProcessGroup group;
  if (!stepped_) heartbeat_.emplace(static_cast<int64_t>(TolerableLateness_s(scenario_.fleet.timing) * 1e9));
  const bool done = StartAll(&group, error) && Watch(&group, error);
  if (!done && ProcessGroup::StopRequested()) interrupted_ = true;
  if (heartbeat_) heartbeat_->Stop();
  ended_s_ = Now_s();
  if (faults_) faults_->KillStopped(control_.get());
  // Where its path leads elsewhere by now, nothing more is written there.
  const bool may_write = folder_.IsThere();
  if (stepped_ && may_write) stepped_->Release();
  group.StopAll(milliseconds(may_write ? 2000 : 0));
  return done;
}

bool FleetRun::StartAll(ProcessGroup* group, std::string* error) {
  epoch_ns_ = clock_->Now() + kStartUpNs;
  recorder_ = std::make_unique<RunRecorder>(scenario_, epoch_ns_, key_);
  if (!OpenLcmLog(group, error)) return false;
  if (!Start(group, "hil", "hil.txt", lines_.Emulation(epoch_ns_), error)) return false;
  for (const ArmEntry& arm : scenario_.fleet.arms) {
    if (!StartBoard(arm.id, false, group, error)) return false;
  }
  const std::string leader = ProcessFaults::kLeaderProcess;
  if (HasLeader(scenario_) && !Start(group, leader, leader + ".txt", lines_.Leader(epoch_ns_), error))
    return false;
  if (stepped_ && !stepped_->AwaitPrograms(group, error)) return false;
  if (stepped_) {
    control_ = std::make_unique<SteppedControl>(stepped_.get(), group);
  } else {
    control_ = std::make_unique<SignalControl>(group);
  }
  started_s_ = Now_s();
  running_ = scenario_.fleet.arms.size() + 1 + (HasLeader(scenario_) ? 1 : 0);
  faults_.emplace(scenario_.faults, BoardInterfaces(scenario_.fleet, options_.hil_buses), clock_, epoch_ns_,
                  At(scenario_.seconds));
  return true;
}

bool FleetRun::OpenLcmLog(ProcessGroup* group, std::string* error) {
  if (!stepped_) return group->Start({kLogger, lines_.LcmLogger(), {}, In("lcm-logger.txt")}, error);
  lcm_log_ = LcmLog::Create(In("lcm.log"), error);
  return lcm_log_ != nullptr;
}

bool FleetRun::StartBoard(int arm_id, bool anew, ProcessGroup* group, std::string* error) {
  const std::string log = "arm_" + std::to_string(arm_id) + (anew ? "_anew" : "") + ".txt";
  return Start(group, ProcessFaults::ArmProcess(arm_id), log, lines_.Board(arm_id, anew, epoch_ns_), error) &&
         (!anew || !stepped_ || stepped_->AwaitPrograms(group, error));
}

bool FleetRun::Start(ProcessGroup* group, const std::string& name, const std::string& log,
                     std::vector<std::string> line, std::string* error) {
  if (!HasFolder(error)) return false;
  if (!stepped_) return group->Start({name, std::move(line), {}, In(log)}, error);
  const auto of_time = stepped_->ArgumentsFor(name);
  line.insert(line.end(), of_time.begin(), of_time.end());
  return group->Start({name, std::move(line), {}, In(log), stepped_->descriptor()}, error);
}

bool FleetRun::HasFolder(std::string* error) const {
  if (folder_.IsThere()) return true;
  *error = options_.out + " was moved or removed while it was written: everything is stopped";
  return false;
}

bool FleetRun::Watch(ProcessGroup* group, std::string* error) {
  int64_t end_ns = At(scenario_.seconds + kOverrun_s);
  int64_t last_look_ns = clock_->Now();
  const int64_t progress_every_ns = isatty(STDOUT_FILENO) != 0 ? 200'000'000 : 5'000'000'000;
  int64_t next_progress_ns = 0;
  while (running_ > faults_->stopped_for_good()) {
    const auto ended = Pass(group);
    TakeMessages();
    TakeLiveFaults();
    if (!MakeFaults(group, error)) return false;
    if (ended && !NoteEnd(*ended, error)) return false;
    if (stepped_ && !stepped_->trouble().empty()) {
      *error = stepped_->trouble();
      return false;
    }
    if (!HasFolder(error)) return false;
    if (ProcessGroup::StopRequested()) {
      interrupted_ = true;
      *error = "interrupted; everything is stopped";
      return false;
    }
    // A stop of this process is nobody's delay; and who has ended is seen one after the other.
    const int64_t now_ns = clock_->Now();
    if (now_ns - last_look_ns > kStood_ns) end_ns += now_ns - last_look_ns;
    last_look_ns = now_ns;
    if (!ended && now_ns > end_ns) {
      *error = "a program is still running " + std::to_string(kOverrun_s) + " s after the end";
      return false;
    }
    if (const int64_t machine_ns = MachineClock::Get()->Now(); machine_ns >= next_progress_ns) {
      ShowProgress();
      next_progress_ns = machine_ns + progress_every_ns;
    }
  }
  std::printf("\n");
  return true;
}

// Time goes on, for a moment. Returns a program that has ended, if one has.
std::optional<ProcessExit> FleetRun::Pass(ProcessGroup* group) {
  const int64_t now_ns = clock_->Now();
  const int64_t until_ns = std::clamp(faults_->Next(), now_ns, now_ns + kMoment_ns);
  if (!stepped_) return group->Poll(nanoseconds(until_ns - now_ns));
  pollfd input{link_->descriptor(), POLLIN, 0};
  return stepped_->Pass(group, {&input, 1}, until_ns);
}

// False with *error set where the run cannot go on without the program.
bool FleetRun::NoteEnd(const ProcessExit& ended, std::string* error) {
  const bool ordered = faults_->TakeOrdered(ended);
  if (ended.Code() == kExitInterrupted && !ordered) {
    *error = ended.name + " (pid " + std::to_string(ended.pid) +
             ") ended before the run did: a signal has stopped it";
    return false;
  }
  if (ended.name == kLogger) {
    *error = In("lcm.log") + " is not complete: " + ended.Describe();
    return false;
  }
  if (!ended.Succeeded() && !ordered && !FinishedItsRun(ended)) {
    *error = ended.Describe();
    return false;
  }
  --running_;
  return true;
}

// A board that ended in FAULT exits with 1, but has done its run and reported: that is a result, not a crash.
bool FleetRun::FinishedItsRun(const ProcessExit& ended) const {
  if (ended.Code() != kExitFailed) return false;
  return std::any_of(scenario_.fleet.arms.begin(), scenario_.fleet.arms.end(), [&](const ArmEntry& arm) {
    return ended.name == ProcessFaults::ArmProcess(arm.id) &&
           fs::exists(In("arm_" + std::to_string(arm.id) + ".json"));
  });
}

void FleetRun::TakeMessages() {
  link_->Drain([&](const LcmMessage& message) {
    recorder_->OnMessage(message);
    if (lcm_log_) lcm_log_->Write(message, message.arrival_ns + clock_->WallNow() - clock_->Now());
  });
}

void FleetRun::TakeLiveFaults() {
  if (live_faults_ == nullptr) return;  // not every file system has pipes
  while (const auto fault = live_faults_->Take(Now_s())) faults_->Add(*fault);
}

bool FleetRun::MakeFaults(ProcessGroup* group, std::string* error) {
  return faults_->MakeDue(
      control_.get(),
      [&](int arm_id, std::string* why) {
        ++running_;
        return StartBoard(arm_id, true, group, why);
      },
      error);
}

void FleetRun::ShowProgress() {
  const double t_s = Now_s();
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
    std::printf("t %5.1f of %g s, %zu of %zu arms, largest |x - x_hat| %8.2f mm", t_s, scenario_.seconds,
                heard, scenario_.fleet.arms.size(), worst_m * 1e3);
    if (!stepped_) std::printf(", missed ticks %lld", static_cast<long long>(missed));
  }
  std::fputs(isatty(STDOUT_FILENO) != 0 ? "  \r" : "\n", stdout);
  std::fflush(stdout);
}

bool FleetRun::Collect(RunMetrics* metrics, nlohmann::ordered_json* json, std::string* error) {
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
  if (stepped_ && stepped_->forgotten() > 0) {
    *error = std::to_string(stepped_->forgotten()) +
             " datagrams waited for a program that was stopped for longer than their times are kept";
    return false;
  }
  if (!recorder_->WriteTraces(options_.out, !stepped_, error)) return false;
  if (!CollectRunResult(scenario_, options_.seed, *recorder_, *faults_, options_.out, metrics, json, error))
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
                                        heartbeat_ ? &*heartbeat_ : nullptr, options_.out);
  evidence.metrics = metrics;
  evidence.started_s = started_s_;
  findings_ = Diagnose(evidence);
  (*json)["diagnosis"] = ToJson(findings_);
  if (!WriteJson(*json, In("metrics.json"), error)) return false;
  return options_.json.empty() || WriteJson(*json, options_.json, error);
}

std::vector<RunFinding> FleetRun::DiagnoseEnd(const std::string& why) const {
  if (recorder_ == nullptr || interrupted_) return {};
  RunEvidence evidence =
      GatherEvidence(scenario_, options_.seed, epoch_ns_, *recorder_, faults_ ? &*faults_ : nullptr,
                     heartbeat_ ? &*heartbeat_ : nullptr, options_.out);
  evidence.started_s = started_s_;
  evidence.broke_off = why;
  evidence.broke_off_s = ended_s_;
  return Diagnose(evidence);
}

}  // namespace armada
