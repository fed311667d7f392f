#include "firmware/can/open_bus.h"

#include "firmware/can/bus_name.h"
#include "firmware/can/udp_bus.h"

namespace armada {

std::unique_ptr<CanBus> OpenBus(std::string_view name, std::string* error) {
  const auto parsed = ParseBusName(name, error);
  if (!parsed) return nullptr;
  switch (parsed->kind) {
    case BusKind::kUdp:
      return UdpCanBus::Open(parsed->group, parsed->port, parsed->ttl, error);
    case BusKind::kSocketCan:
      *error = "bus \"" + std::string(name) +
               "\": SocketCAN is not in this version of Armada; use the user-space bus udp:<group>:<port>";
      return nullptr;
  }
  return nullptr;
}

}  // namespace armada
