#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "firmware/can/bus.h"
#include "firmware/can/can_bus_config.h"

namespace armada {

/// Opens the bus that `name` stands for (see ParseBusName). On failure returns null and writes one message
/// that says what to do. The user-space bus carries everything and needs no options. Start-up only: it
/// allocates.
std::unique_ptr<CanBus> OpenBus(std::string_view name, const BusOptions& options, std::string* error);

}  // namespace armada
