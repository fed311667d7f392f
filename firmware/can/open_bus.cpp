#include "firmware/can/open_bus.h"

#include "firmware/can/bus_name.h"
#include "firmware/can/socketcan_bus.h"
#include "firmware/can/udp_bus.h"

namespace armada {

std::unique_ptr<CanBus> OpenBus(std::string_view name, const BusOptions& options, Clock* clock,
                                std::string* error) {
  const auto parsed = ParseBusName(name, error);
  if (!parsed) return nullptr;
  switch (parsed->kind) {
    case BusKind::kUdp:
      return UdpCanBus::Open(parsed->group, parsed->port, parsed->ttl, clock, error);
    case BusKind::kSocketCan:
      return SocketCanBus::Open(parsed->interface_name, options, error);
  }
  return nullptr;
}

}  // namespace armada
