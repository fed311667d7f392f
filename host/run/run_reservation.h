#pragma once

#include <string>
#include <vector>

#include "firmware/app/fleet.h"
#include "firmware/unique_fd.h"

namespace armada {

/// The LCM network and the CAN buses that one run has to itself in its network namespace: names of abstract
/// Unix sockets, which the kernel frees when this process ends in whatever way.
class RunReservation {
 public:
  /// Reserves all or nothing. False when another run has one of them, with which and who in `taken`.
  bool Take(const std::vector<std::string>& names, std::string* taken);

 private:
  std::vector<UniqueFd> sockets_;
};

/// What a run of the fleet has to have to itself: its LCM group and port, and every bus. `hil_buses`: those
/// that the emulation opens in place of a board's (`<arm>=<bus>`). Names are as in configurations.
std::vector<std::string> NamesToReserve(const FleetConfig& fleet, const std::vector<std::string>& hil_buses);

}  // namespace armada
