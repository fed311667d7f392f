#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "firmware/can/bus.h"
#include "firmware/can/can_bus_config.h"
#include "firmware/clock/clock.h"

namespace armada {

/// Opens the bus that `name` stands for (see ParseBusName). On failure returns null and writes one message
/// that says what to do. The user-space bus carries everything and needs no options; a bus of the kernel has
/// the machine's clock, whatever `clock` is, which outlives the object. Start-up only: it allocates.
std::unique_ptr<CanBus> OpenBus(std::string_view name, const BusOptions& options, Clock* clock,
                                std::string* error);

}  // namespace armada
