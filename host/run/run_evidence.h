#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware/link/messages.h"
#include "hil/scenario.h"
#include "host/json.h"
#include "host/metrics.h"
#include "host/run/heartbeat.h"
#include "host/run/process_faults.h"
#include "host/run/run_recorder.h"

namespace armada {

/// What is known of a run when it is over: what a diagnosis is made of.
struct RunEvidence {
  /// Of one arm, in the order of the fleet.
  struct Arm {
    std::span<const telemetry_t> ticks;  ///< that were heard
    Json board;                          ///< arm_<id>.json; null when its board has left none
    Json bench;                          ///< its part of hil.json; null when the emulation has left none
  };

  const ScenarioConfig* scenario = nullptr;
  uint64_t seed = 1;
  int64_t epoch_ns = 0;
  std::vector<Arm> arms;
  Json hil;                             ///< hil.json, or null
  const RunMetrics* metrics = nullptr;  ///< none when the run broke off
  bool real_time = true;                ///< the machine's; else none of it counts
  std::vector<Stall> stalls;
  std::vector<Silence> leader_silences;
  bool heartbeat_is_foremost = true;
  int processors = 1;
  std::vector<ProcessFaults::Made> faults_made;
  double started_s = -1.0;  ///< when every program had been started
  std::string broke_off;    ///< why, when it did: a program's end with the end of its log
  double broke_off_s = 0.0;

  double TimeOf(int64_t t_ns) const { return 1e-9 * static_cast<double>(t_ns - epoch_ns); }
};

/// Everything but how the run ended. `faults`: may be null; `heartbeat`: null in stepped time. The recorder
/// and the scenario outlive the result.
RunEvidence GatherEvidence(const ScenarioConfig& scenario, uint64_t seed, int64_t epoch_ns,
                           const RunRecorder& recorder, const ProcessFaults* faults,
                           const Heartbeat* heartbeat, const std::string& directory);

}  // namespace armada
