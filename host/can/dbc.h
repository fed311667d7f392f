#pragma once

#include <span>
#include <string>
#include <vector>

#include "host/can/bus_messages.h"

namespace armada {

/// A bus as a DBC file, and what of it a DBC file cannot say.
struct Dbc {
  std::string text;                  ///< lines end in \n
  std::vector<std::string> dropped;  ///< "J1_Enable": names of messages that are left out
};

/// Signals, units and scales of one bus for CAN tools, out of the tables that the codecs are made of. A DBC
/// file has one multiplexor an identifier: of messages that share one, those stay that are told apart like
/// the last of them, the general one; special frames ahead of it are dropped, and the comments say so.
/// `name`: of the bus, for the comment.
Dbc MakeDbc(const std::string& name, std::span<const BusMessage> messages);

}  // namespace armada
