#pragma once

#include <span>
#include <string>
#include <vector>

#include "firmware/can/joint_drive_config.h"
#include "firmware/can/signal.h"

namespace armada {

/// A message and whose it is.
struct BusMessage {
  std::string owner;  ///< "J1" the first joint's, "N5" of node 5; empty: one message for all, such as SYNC
  CanMessage message;
};

/// All messages of one bus, joints "J1" and on. What is the same for several joints comes once. Where several
/// share an identifier, the first that fits a frame is meant. For tools: it allocates.
std::vector<BusMessage> MessagesOfBus(std::span<const JointDriveConfig> joints);

/// Messages of a drive profile without a fleet: default ranges and units, every address that it can have,
/// "N1" and on.
std::vector<BusMessage> MessagesOfProfile(DriveProfile profile);

/// The message that the frame is, or null. The frame may still be shorter than the message.
const BusMessage* FindMessage(std::span<const BusMessage> messages, const CanFrame& frame);

/// Bytes that the signal reaches to.
unsigned EndByte(const CanSignal& signal);

}  // namespace armada
