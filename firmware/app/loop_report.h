#pragma once

#include <iosfwd>

#include "firmware/app/arm_loop.h"
#include "firmware/app/realtime.h"

namespace armada {

/// The board's own figures as JSON: "timing", "memory" and "bus" of metrics.json, and the controller's end
/// state.
void WriteLoopReport(const ArmLoop& loop, const ArmNode& node, const CanBus& bus, const LcmEndpoint& link,
                     const RealtimeGrant& grant, std::ostream& out);

}  // namespace armada
