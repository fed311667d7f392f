#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware/link/lcm_endpoint.h"
#include "firmware/link/messages.h"
#include "firmware/link/seal.h"
#include "hil/leader_path.h"
#include "hil/scenario.h"
#include "hil/tracking_record.h"
#include "host/metrics.h"

namespace armada {

/// A time in which a program was not heard; times of the run.
struct Silence {
  double begin_s = 0.0;
  double end_s = 0.0;
};

/// Listens to a running fleet on LCM and keeps what the report and metrics.json need: what every controller
/// saw and did.
class RunRecorder {
 public:
  RunRecorder(const ScenarioConfig& scenario, int64_t epoch_ns, const FleetKey& key);

  void OnMessage(const LcmMessage& message);

  /// Every tick of an arm that was heard, in order.
  std::span<const telemetry_t> Ticks(size_t index) const { return arms_[index].telemetry; }
  /// Newest tick of each arm, for the progress line; none before its first.
  const std::optional<telemetry_t>& Latest(size_t index) const { return arms_[index].latest; }
  /// When the leader was not heard for several of its periods, in order; never before the run's time 0 nor
  /// after its end. Messages that it sent and that were lost on the way here are none of its silence.
  std::vector<Silence> LeaderSilences() const;
  /// True when every arm of the fleet has been heard.
  bool EveryArmHeard() const;

  /// The part of the result that only the controllers know: estimates, torques, parameters, subtask, state.
  ArmMetrics Metrics(size_t index) const;
  /// Errors against the leader, or against where the estimates agree, at the boards' ticks.
  TrackingRecord Tracking(size_t index) const;
  /// Largest distance between two arms' estimates of x in the window, m.
  double EstimateSpread() const;
  /// Writes leader.csv, arm_<id>.csv and, of a run in real time, timing.csv. False with *error set.
  bool WriteTraces(const std::string& directory, bool with_timing, std::string* error) const;

 private:
  struct ArmRecord {
    ArmRecord(const FleetKey& key, int arm_id) : estimate_seal(key, arm_id), telemetry_seal(key, arm_id) {}
    SealCheck estimate_seal;
    SealCheck telemetry_seal;
    std::vector<telemetry_t> telemetry;
    std::vector<estimate_t> estimates;
    std::optional<telemetry_t> latest;
  };
  void OnLeader(const leader_t& message, int64_t arrival_ns);
  std::optional<Silence> LeaderSilenceUntil(int64_t until_ns, int64_t lost) const;
  double TimeOf(int64_t stamp_ns) const { return 1e-9 * static_cast<double>(stamp_ns - epoch_ns_); }
  bool InWindow(int64_t stamp_ns) const;
  Zeta TruthAt(int64_t stamp_ns) const;

  const ScenarioConfig& scenario_;
  int64_t epoch_ns_;
  std::optional<LeaderPath> leader_;
  std::vector<ArmRecord> arms_;
  SealCheck leader_seal_;
  int64_t leader_sequence_ = 0;
  int64_t leader_heard_ns_;
  std::vector<Silence> leader_silences_;
  int64_t heard_ns_ = 0;  ///< the newest message of anybody
};

}  // namespace armada
