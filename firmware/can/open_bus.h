#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "firmware/can/bus.h"

namespace armada {

/// Opens the bus that `name` stands for (see ParseBusName). On failure returns null and writes one message
/// that says what to do. Start-up only: it allocates.
std::unique_ptr<CanBus> OpenBus(std::string_view name, std::string* error);

}  // namespace armada
