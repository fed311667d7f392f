#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "firmware/app/fleet.h"
#include "host/run/run_command.h"

namespace armada {

/// Makes the fleet's buses those of `--bus`: on socketcan an arm whose bus is of another kind has
/// socketcan:vcan<id>. Returns what is wrong with the options; empty when nothing is.
std::string ChooseBuses(const RunOptions& options, FleetConfig* fleet);

/// The interface of a bus name; empty where it is of another kind.
std::string SocketCanInterface(const std::string& bus);

/// All interfaces of the boards, then those that the emulation has in their place (`<arm>=<bus>`).
std::vector<std::string> SocketCanInterfaces(const FleetConfig& fleet,
                                             const std::vector<std::string>& hil_buses);

/// For people: which of the interfaces were made for this run, and which were there.
void PrintCanInterfaces(const std::vector<std::string>& interfaces, const std::vector<std::string>& made,
                        std::ostream& out);

}  // namespace armada
