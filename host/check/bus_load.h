#pragma once

#include "firmware/app/fleet.h"

namespace armada {

inline constexpr double kCanBitrate = 1e6;  ///< bit/s of a classic bus

/// Longest a classic frame can be on the wire, bits: with every stuff bit that its length allows, and the 3
/// bits between frames. 135 for 8 bytes and an 11-bit identifier.
int WorstFrameBits(const CanFrame& frame);

/// Share of its bus that the steady traffic of one arm takes at worst: each tick a sample request, its answer
/// and a torque for every joint, the drives' heartbeats, and their cyclic estimates where `feedback_period_s`
/// is not 0.
double ArmBusLoad(const ArmEntry& entry, double period_s, double feedback_period_s);

}  // namespace armada
