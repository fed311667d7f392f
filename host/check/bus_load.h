#pragma once

#include "firmware/app/fleet.h"
#include "hil/emulated_drive.h"

namespace armada {

/// Share of its bus that the steady traffic of one arm takes, every frame as long as stuff bits can make it:
/// a second of ticks of the arm's master codecs with emulated drives, everything that either side says
/// counted. Infinity when the drives do not come up.
double ArmBusLoad(const ArmEntry& entry, const TimingConfig& timing, const EmulatedDriveConfig& drive);

}  // namespace armada
