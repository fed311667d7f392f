#pragma once

#include "firmware/can/can_bus_config.h"
#include "firmware/can/frame.h"

namespace armada {

/// Longest time that a frame can take on the wire, s: with every stuff bit that its length allows, and the 3
/// bits between frames. ISO 11898-1:2015. A classic frame of 8 bytes and an 11-bit identifier: 135 bits.
double WorstFrameTime_s(const CanFrame& frame, const CanBusConfig& bus);

}  // namespace armada
