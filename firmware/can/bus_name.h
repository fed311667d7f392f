#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace armada {

enum class BusKind {
  kUdp,        ///< user-space bus over UDP multicast
  kSocketCan,  ///< CAN interface of the Linux kernel
};

/// A bus name of the fleet file, taken apart.
struct BusName {
  BusKind kind = BusKind::kUdp;
  std::string group;           ///< kUdp: IPv4 multicast group, dotted
  uint16_t port = 0;           ///< kUdp: 1 to 65535
  uint8_t ttl = 0;             ///< kUdp: hops; 0 stays on this host
  std::string interface_name;  ///< kSocketCan: 1 to 15 characters
};

/// Parses `udp:<group>:<port>`, `udp:<group>:<port>?ttl=<hops>` or `socketcan:<interface>`. On failure
/// returns nothing and writes one sentence that names what was given and what is allowed. Start-up only: it
/// allocates.
std::optional<BusName> ParseBusName(std::string_view text, std::string* error);

}  // namespace armada
