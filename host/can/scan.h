#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "firmware/can/bus.h"
#include "firmware/can/drive_profile.h"

namespace armada {

struct ScanOptions {
  double listen_s = 1.0;                ///< before anything is asked
  std::optional<DriveProfile> profile;  ///< ask as this one only; none: as all that can be asked
  bool fd = false;                      ///< the bus carries CAN FD: ask moteus, too
};

struct FoundDrive {
  std::string profile;  ///< as in the fleet file; "canopen" for a node that is no CiA 402 drive
  int node_id = 0;
  std::string firmware;  ///< as far as it was told
  std::string state;     ///< as far as it was told
};

struct ScanResult {
  std::vector<FoundDrive> drives;  ///< in order of profile and node
  uint64_t heard = 0;              ///< frames before the first question
  /// Why nothing was asked, or not everything; empty when all was.
  std::vector<std::string> notes;
  BusStatus status = BusStatus::kOk;  ///< why it ended early
};

/// Finds the drives of a bus. It listens first, and asks only on a bus on which nobody commands and no ODrive
/// is armed. Questions read: ODrive Get_Version as a remote frame, to nodes that were heard; CANopen SDO
/// uploads of 1000h, 1018h, 100Ah, 1008h and 6502h; Damiao register reads; moteus register reads. Nothing is
/// written, enabled or moved. mini-cheetah and CubeMars have no question that is not a command: they are not
/// found. `now_ns`: CLOCK_MONOTONIC.
ScanResult Scan(CanBus* bus, const ScanOptions& options, int64_t now_ns);

}  // namespace armada
