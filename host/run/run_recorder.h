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
  double TimeOf(int64_t stamp_ns) const { return 1e-9 * static_cast<double>(stamp_ns - epoch_ns_); }
  bool InWindow(int64_t stamp_ns) const;
  Zeta TruthAt(int64_t stamp_ns) const;

  const ScenarioConfig& scenario_;
  int64_t epoch_ns_;
  std::optional<LeaderPath> leader_;
  std::vector<ArmRecord> arms_;
};

}  // namespace armada
