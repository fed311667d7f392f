#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "firmware/link/fleet_key.h"
#include "firmware/link/lcm_endpoint.h"
#include "hil/live_faults.h"
#include "hil/scenario.h"
#include "host/metrics.h"
#include "host/process_group.h"
#include "host/run/heartbeat.h"
#include "host/run/lcm_log.h"
#include "host/run/process_faults.h"
#include "host/run/program_control.h"
#include "host/run/run_command.h"
#include "host/run/run_finding.h"
#include "host/run/run_folder.h"
#include "host/run/run_lines.h"
#include "host/run/run_networks.h"
#include "host/run/run_recorder.h"
#include "host/run/stepped_time.h"

namespace armada {

/// One run of a scenario as processes, by one thread: Prepare, Execute, Collect, in this order, each once.
/// What fails returns false and says why in `error`.
class FleetRun {
 public:
  /// `options` and `folder`, which is options.out, outlive this object.
  FleetRun(const RunOptions& options, const RunFolder& folder, ScenarioConfig scenario);

  /// Networks, clock, key and inputs.
  bool Prepare(std::string* error);
  /// All programs from their start to their end; none is left behind, whatever happens.
  bool Execute(std::string* error);
  /// What they left, into metrics.json.
  bool Collect(RunMetrics* metrics, nlohmann::ordered_json* json, std::string* error);
  /// Of a run that broke off; empty where it had not begun.
  std::vector<RunFinding> DiagnoseEnd(const std::string& why) const;
  bool interrupted() const { return interrupted_; }
  const std::vector<RunFinding>& findings() const { return findings_; }

 private:
  bool MakeKey(std::string* error);
  bool WriteInputs(std::string* error);
  bool StartAll(ProcessGroup* group, std::string* error);
  bool StartBoard(int arm_id, bool anew, ProcessGroup* group, std::string* error);
  bool Start(ProcessGroup* group, const std::string& name, const std::string& log,
             std::vector<std::string> line, std::string* error);
  bool HasFolder(std::string* error) const;
  bool OpenLcmLog(ProcessGroup* group, std::string* error);
  bool Watch(ProcessGroup* group, std::string* error);
  std::optional<ProcessExit> Pass(ProcessGroup* group);
  bool NoteEnd(const ProcessExit& ended, std::string* error);
  void TakeMessages();
  bool FinishedItsRun(const ProcessExit& ended) const;
  bool MakeFaults(ProcessGroup* group, std::string* error);
  void TakeLiveFaults();
  void ShowProgress();
  std::string In(const std::string& name) const { return lines_.In(name); }
  /// Seconds of the run.
  double Now_s() const { return 1e-9 * static_cast<double>(clock_->Now() - epoch_ns_); }
  /// When `seconds` of it are over.
  int64_t At(double seconds) const { return epoch_ns_ + static_cast<int64_t>(seconds * 1e9); }

  const RunOptions& options_;
  const RunFolder& folder_;
  ScenarioConfig scenario_;
  RunLines lines_;
  RunNetworks networks_;                  // before what uses them: removed last
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
  double started_s_;  ///< when every program was; time of the run
  double ended_s_ = 0.0;
  std::vector<RunFinding> findings_;
  size_t running_ = 0;  ///< programs whose end is awaited
  bool interrupted_ = false;
};

}  // namespace armada
