#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "firmware/can/can_bus_config.h"

namespace armada {

/// A CAN interface of the kernel, as netlink tells of it.
struct CanLink {
  std::string name;
  std::string kind;  ///< "can": a controller; "vcan", "vxcan": virtual ones, without bit timing and queue
  bool up = false;
  bool is_can = false;
  uint32_t mtu = 0;  ///< 16: classic frames only; 72: CAN FD, too
  uint32_t tx_queue_length = 0;
  std::optional<uint32_t> bitrate_bit_s;       ///< controllers
  std::optional<uint32_t> data_bitrate_bit_s;  ///< controllers set to CAN FD
  uint32_t restart_ms = 0;                     ///< controllers; 0: no restart by itself after bus-off
  bool listen_only = false;
};

/// Start-up only: it allocates. Nothing, and the reason in `error`, when there is no such interface.
std::optional<CanLink> ReadCanLink(const std::string& name, std::string* error);

/// What of the interface does not fit, with the `ip link` commands that mend it; empty when all does.
std::string CheckCanLink(const CanLink& link, const BusOptions& options);

}  // namespace armada
