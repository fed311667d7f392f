#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "firmware/app/fleet.h"
#include "firmware/can/bus.h"
#include "hil/hil_clock.h"

namespace armada {

/// A drive that somebody else runs on a bus.
struct ActiveDrive {
  size_t bus = 0;  ///< index
  int node_id = 0;
};

/// Listens to all buses, one an arm of the fleet, for `listen_ns` and returns the first drive that says
/// something, if there is one: an emulation beside it would answer the same requests with the state of
/// another plant. Frames of boards do not count; what is heard is thrown away. Ends early when the run is
/// asked to end.
std::optional<ActiveDrive> FindActiveDrive(const FleetConfig& fleet,
                                           const std::vector<std::unique_ptr<CanBus>>& buses,
                                           int64_t listen_ns, HilClock* clock);

}  // namespace armada
