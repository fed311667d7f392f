#pragma once

#include <cstdint>
#include <initializer_list>
#include <random>
#include <string>
#include <vector>

#include "firmware/can/frame.h"

namespace armada {

/// A classic data frame with an 11-bit identifier.
CanFrame DataFrame(uint32_t id, std::initializer_list<uint8_t> data);

/// Any frame a bus can carry, all kinds and lengths.
CanFrame RandomFrame(std::mt19937_64* random);

/// Everything that was on the wire, as one line of words (the stamp is not):
/// id extended remote error fd bitrate_switch error_state_indicator length data-in-hex-or-minus.
std::string Describe(const CanFrame& frame);

std::vector<uint8_t> FromHex(const std::string& hex);

}  // namespace armada
