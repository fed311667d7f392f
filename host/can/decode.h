#pragma once

#include <span>
#include <string>
#include <string_view>

#include "firmware/can/frame.h"
#include "host/can/bus_messages.h"

namespace armada {

/// A frame in words: whose it is, the message and its signals in physical units, "J1 State position=1.25
/// rev". Values are those on the wire: motor side. A frame that no message fits, or that is shorter than its
/// message, is shown as it is; an error frame is named.
std::string Decode(std::span<const BusMessage> messages, const CanFrame& frame);

/// What an error frame tells, after linux/can/error.h: "bus off, controller problem". `error_class`: its
/// identifier without flags.
std::string ErrorClassName(uint32_t error_class);

/// As candump shows it: "123#0102".
std::string RawText(const CanFrame& frame);

}  // namespace armada
