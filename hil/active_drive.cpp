#include "hil/active_drive.h"

#include "firmware/can/make_drive.h"

namespace armada {

std::optional<ActiveDrive> FindActiveDrive(const FleetConfig& fleet,
                                           const std::vector<std::unique_ptr<CanBus>>& buses,
                                           int64_t listen_ns, HilClock* clock) {
  std::vector<std::vector<std::unique_ptr<JointDrive>>> listeners;
  for (const ArmEntry& arm : fleet.arms) listeners.push_back(MakeDrives(arm.joints));
  const int64_t end_ns = clock->Now() + listen_ns;
  while (clock->Now() < end_ns && clock->WaitUntil(end_ns)) {
    for (size_t i = 0; i < buses.size(); ++i) {
      CanFrame frame;
      while (buses[i]->Receive(0, &frame) == BusStatus::kOk) {
        for (size_t joint = 0; joint < listeners[i].size(); ++joint) {
          if (listeners[i][joint]->OnFrame(frame) == Reception::kTaken) {
            return ActiveDrive{i, fleet.arms[i].joints[joint].node_id};
          }
        }
        if (clock->Now() >= end_ns) return std::nullopt;
      }
    }
  }
  return std::nullopt;
}

}  // namespace armada
