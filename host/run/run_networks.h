#pragma once

#include <string>

#include "firmware/app/fleet.h"
#include "host/run/run_command.h"
#include "host/run/run_reservation.h"
#include "host/run/virtual_can.h"

namespace armada {

/// The networks of one run: LCM's multicast, and the kernel's CAN where the fleet is on it. They go with the
/// object.
class RunNetworks {
 public:
  /// Reserves what is there, makes what is missing, and moves this process to a network namespace of its own
  /// where the run needs one; says so. With boards in namespaces, `fleet` has another link.lcm_url after it.
  bool Provide(const RunOptions& options, FleetConfig* fleet, std::string* error);

 private:
  RunReservation reservation_;
  VirtualCan virtual_can_;
};

}  // namespace armada
