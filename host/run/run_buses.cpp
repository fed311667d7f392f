#include "host/run/run_buses.h"

#include <algorithm>
#include <ostream>

#include "firmware/can/bus_name.h"

namespace armada {
namespace {

// Each reads `<arm>=<bus>`; armada-hil checks more.
std::string CheckHilBuses(const RunOptions& options) {
  for (const std::string& text : options.hil_buses) {
    const size_t sign = text.find('=');
    std::string error;
    if (sign == std::string::npos || !ParseBusName(text.substr(sign + 1), &error))
      return "--hil-bus " + text + ": must be <arm>=<bus>, such as 1=socketcan:can1";
  }
  if (!options.hil_buses.empty() && (options.namespaces || options.bus != "socketcan")) {
    return "--hil-bus is for --bus socketcan without --namespaces: otherwise both ends of a bus have one "
           "name";
  }
  return {};
}

}  // namespace

std::string ChooseBuses(const RunOptions& options, FleetConfig* fleet) {
  if (options.bus != "udp" && options.bus != "socketcan" && options.bus != "vm") {
    return "--bus " + options.bus +
           ": there are udp (the user-space bus), socketcan (the kernel's CAN) and vm " +
           "(the same in a virtual machine whose kernel has CAN)";
  }
  if (options.namespaces && options.bus == "udp") return "--namespaces needs --bus socketcan or --bus vm";
  if (std::string wrong = CheckHilBuses(options); !wrong.empty()) return wrong;
  for (ArmEntry& arm : fleet->arms) {
    const bool socketcan = !SocketCanInterface(arm.bus).empty();
    if (options.bus == "udp" && socketcan) {
      return "arm " + std::to_string(arm.id) + " has bus " + arm.bus +
             ": run it with --bus socketcan or --bus vm";
    }
    if (options.bus != "udp" && !socketcan) arm.bus = "socketcan:vcan" + std::to_string(arm.id);
  }
  return {};
}

std::string SocketCanInterface(const std::string& bus) {
  std::string ignored;
  const auto name = ParseBusName(bus, &ignored);
  return name && name->kind == BusKind::kSocketCan ? name->interface_name : "";
}

std::vector<std::string> SocketCanInterfaces(const FleetConfig& fleet,
                                             const std::vector<std::string>& hil_buses) {
  std::vector<std::string> interfaces;
  const auto add = [&](const std::string& bus) {
    if (const std::string name = SocketCanInterface(bus); !name.empty()) interfaces.push_back(name);
  };
  for (const ArmEntry& arm : fleet.arms) add(arm.bus);
  for (const std::string& text : hil_buses) add(text.substr(text.find('=') + 1));
  return interfaces;
}

void PrintCanInterfaces(const std::vector<std::string>& interfaces, const std::vector<std::string>& made,
                        std::ostream& out) {
  const auto print = [&](const char* title, bool wanted) {
    bool first = true;
    for (const std::string& name : interfaces) {
      if ((std::find(made.begin(), made.end(), name) != made.end()) != wanted) continue;
      out << (first ? title : " ") << name;
      first = false;
    }
    if (!first) out << '\n';
  };
  print("CAN interfaces made for this run: ", true);
  print("CAN interfaces used as they are: ", false);
}

}  // namespace armada
