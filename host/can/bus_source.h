#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/app/fleet.h"
#include "firmware/can/drive_profile.h"
#include "host/can/bus_messages.h"

namespace armada {

/// Where a tool's tables come from, as the command line says: a fleet's arm, or a profile.
struct BusSource {
  std::string fleet;
  std::optional<int> arm;         ///< may be left out of a fleet of one arm
  std::vector<std::string> sets;  ///< `key=value` on top of the fleet
  std::string profile;
};

/// The arm that the source names. On failure prints why to standard error and sets `code`.
std::optional<ArmEntry> FindArm(const BusSource& source, int* code);

/// "odrive_cansimple" and on. Nothing, and one sentence on standard error, for any other name.
std::optional<DriveProfile> ParseProfile(const std::string& name);

/// How to open a bus whose set-up is not ours to judge: a CAN interface with the bit rates and the queue that
/// it has, CAN FD if it has that.
BusOptions OptionsAsFound(const std::string& bus);

}  // namespace armada
