#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "firmware/app/fleet.h"
#include "host/check/check_result.h"

namespace armada {

/// One arm's bus, as far as it can be judged without sending a frame.
struct BusCheck {
  int arm_id = 0;
  std::string bus;
  double load = 0.0;      ///< share of the bus, see ArmBusLoad
  std::string interface;  ///< what was found of it, "up, 1000000 bit/s"
  std::vector<JointDriveConfig> joints;
};

struct CanCheckResult {
  std::string fleet;
  std::vector<BusCheck> buses;
  std::vector<Finding> findings;

  bool ok() const;  ///< no finding is an error
};

/// What becomes of the joint's watchdog at bring-up: "written and read back: proved".
const char* WatchdogText(DriveProfile profile);

/// Identifiers that collide are errors of the fleet file and never come here.
CanCheckResult CheckCan(const FleetConfig& fleet);

void PrintText(const CanCheckResult& result, std::ostream& out);
void PrintJson(const CanCheckResult& result, std::ostream& out);

}  // namespace armada
