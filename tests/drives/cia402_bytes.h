#pragma once

#include <string>

#include "firmware/can/frame.h"

namespace armada {

/// Frame of can-utils' notation, "123#0102", "12345678#01" for a 29-bit identifier, "123#R" for a remote one.
CanFrame Frame(const std::string& text);

/// The other way, in capitals.
std::string Text(const CanFrame& frame);

}  // namespace armada
