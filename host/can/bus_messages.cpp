#include "host/can/bus_messages.h"

#include <algorithm>

#include "firmware/can/make_drive.h"

namespace armada {
namespace {

/// Of what several drives have alike, such as SYNC, one is kept, and it is no one's own.
void Add(const std::string& owner, const CanMessage& message, std::vector<BusMessage>* messages) {
  const auto same = std::find_if(messages->begin(), messages->end(), [&](const BusMessage& other) {
    return other.message.id == message.id && other.message.extended == message.extended &&
           other.message.multiplexor < 0 && message.multiplexor < 0;
  });
  if (same == messages->end()) return messages->push_back({owner, message});
  if (same->owner != owner) same->owner.clear();
}

}  // namespace

std::vector<BusMessage> MessagesOfBus(std::span<const JointDriveConfig> joints) {
  std::vector<BusMessage> messages;
  for (size_t i = 0; i < joints.size(); ++i) {
    for (const CanMessage& message : MessagesOf(joints[i])) {
      Add("J" + std::to_string(i + 1), message, &messages);
    }
  }
  return messages;
}

std::vector<BusMessage> MessagesOfProfile(DriveProfile profile) {
  std::vector<BusMessage> messages;
  const NodeIdRange range = NodeIdsOf(profile);
  const bool odrive =
      profile == DriveProfile::kODriveCanSimple || profile == DriveProfile::kODriveCanSimpleV05;
  for (int node = odrive ? 0 : std::max(range.min, 1); node <= range.max; ++node) {
    const JointDriveConfig joint{.profile = profile, .node_id = node};
    for (const CanMessage& message : MessagesOf(joint)) Add("N" + std::to_string(node), message, &messages);
  }
  return messages;
}

const BusMessage* FindMessage(std::span<const BusMessage> messages, const CanFrame& frame) {
  if (frame.error) return nullptr;
  for (const BusMessage& candidate : messages) {
    const CanMessage& message = candidate.message;
    if (message.id != frame.id || message.extended != frame.extended || message.fd != frame.fd) continue;
    if (message.multiplexor < 0 || frame.remote) return &candidate;
    const CanSignal& multiplexor = message.signals[static_cast<size_t>(message.multiplexor)];
    if (EndByte(multiplexor) <= frame.length && GetRaw(frame, multiplexor) == message.multiplexor_raw) {
      return &candidate;
    }
  }
  return nullptr;
}

unsigned EndByte(const CanSignal& signal) {
  if (signal.byte_order == CanSignal::ByteOrder::kLittle) return (signal.start_bit + signal.bits + 7u) / 8u;
  const unsigned before = signal.start_bit / 8u * 8u + (7u - signal.start_bit % 8u);  // bits sent before it
  return (before + signal.bits + 7u) / 8u;
}

}  // namespace armada
