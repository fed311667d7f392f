#pragma once

#include <memory>
#include <span>
#include <vector>

#include "firmware/can/joint_drive.h"
#include "firmware/can/signal.h"

namespace armada {

/// The master's side of the drives on one bus, in order of the joints. Drives of one family share what their
/// bus needs once: the first of the CANopen drives sends SYNC and the master's heartbeat. Start-up only: it
/// allocates.
std::vector<std::unique_ptr<JointDrive>> MakeDrives(std::span<const JointDriveConfig> joints);

/// What the joint's drive and its master put on the bus, message by message: the tables that the codecs are
/// made of, with the identifiers and scales of this joint. For tools: it allocates.
std::vector<CanMessage> MessagesOf(const JointDriveConfig& joint);

}  // namespace armada
