#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware/app/realtime.h"
#include "hil/can_log.h"
#include "hil/hil_server.h"

namespace armada {

/// What a run of armada-hil leaves behind: hil.json.
struct HilReport {
  std::string scenario;
  uint64_t seed = 0;
  int64_t epoch_ns = 0;
  int64_t epoch_wall_ns = 0;  ///< the same on the clock that witnesses stamp frames with
  double seconds = 0.0;       ///< fleet time that was run
  HilEnd end = HilEnd::kDone;
  std::vector<HilArmResult> arms;
  DurationHistogram pacing;
  double latest_at_s = 0.0;                  ///< fleet time at which pacing was at its maximum
  std::vector<FaultConfig> faults_taken;     ///< while it ran
  std::optional<uint64_t> heap_allocations;  ///< while it ran; none where they cannot be counted
  int64_t page_faults = 0;                   ///< while it ran
  RealtimeGrant grant;
};

/// Writes the report as JSON. `logs`: of the arms in order. False with `*error` set.
bool WriteHilReport(const HilReport& report, const std::vector<std::unique_ptr<CanLog>>& logs,
                    const std::string& path, std::string* error);

}  // namespace armada
