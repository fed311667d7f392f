#include "hil/active_drive.h"

#include "firmware/can/odrive_messages.h"

namespace armada {
namespace {

constexpr int kNodes = 64;

std::optional<int> NodeOfHeartbeat(const CanFrame& frame) {
  odrive::Heartbeat heartbeat;
  for (int node = 0; node < kNodes; ++node) {
    if (odrive::DecodeHeartbeat(frame, node, odrive::Firmware::kV06, &heartbeat)) return node;
  }
  return std::nullopt;
}

}  // namespace

std::optional<ActiveDrive> FindActiveDrive(const std::vector<std::unique_ptr<CanBus>>& buses,
                                           int64_t listen_ns, HilClock* clock) {
  const int64_t end_ns = clock->Now() + listen_ns;
  while (clock->Now() < end_ns && clock->WaitUntil(end_ns)) {
    for (size_t i = 0; i < buses.size(); ++i) {
      CanFrame frame;
      while (buses[i]->Receive(0, &frame) == BusStatus::kOk) {
        if (const auto node = NodeOfHeartbeat(frame)) return ActiveDrive{i, *node};
        if (clock->Now() >= end_ns) return std::nullopt;
      }
    }
  }
  return std::nullopt;
}

}  // namespace armada
