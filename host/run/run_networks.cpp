#include "host/run/run_networks.h"

#include <algorithm>
#include <iostream>
#include <vector>

#include "firmware/link/lcm_url.h"
#include "host/private_network.h"
#include "host/run/board_networks.h"
#include "host/run/run_buses.h"

namespace armada {
namespace {

// The boards' LCM leaves their namespaces: one hop at least.
bool GiveEachBoardItsOwn(FleetConfig* fleet, LcmUrl url, std::string* error) {
  url.ttl = std::max(url.ttl, 1);
  fleet->link.lcm_url = ToString(url);
  BoardNetworks networks;
  if (!networks.Enter(error)) return false;
  for (const ArmEntry& arm : fleet->arms) {
    if (!networks.Add(arm.id, SocketCanInterface(arm.bus), error)) return false;
  }
  std::cout << "each board in a network namespace of its own, LCM on " << fleet->link.lcm_url << '\n';
  return true;
}

// Interfaces that are there would be out of reach in a network of our own, and so would other boards.
bool EnterOwnNetwork(const std::string& why, const LcmUrl& url, const std::vector<std::string>& interfaces,
                     std::string* error) {
  const bool bound = std::any_of(interfaces.begin(), interfaces.end(), VirtualCan::Exists);
  if (bound) {
    *error = why + ", and the CAN interfaces are of this network";
  } else if (url.ttl > 0) {
    *error =
        why + ", and link.lcm_url has ttl=" + std::to_string(url.ttl) + ": other boards could not be heard";
  } else if (EnterPrivateNetwork(error)) {
    std::cout << why << ": running in a private network namespace\n";
    return true;
  } else {
    *error = why + ", and " + *error;
  }
  return false;
}

}  // namespace

bool RunNetworks::Provide(const RunOptions& options, FleetConfig* fleet, std::string* error) {
  const auto url = ParseLcmUrl(fleet->link.lcm_url, error);
  if (!url) return false;
  if (options.namespaces) return GiveEachBoardItsOwn(fleet, *url, error);
  const std::vector<std::string> interfaces = SocketCanInterfaces(*fleet, options.hil_buses);
  const std::vector<std::string> wanted = NamesToReserve(*fleet, options.hil_buses);
  // As fast as it goes nobody could follow anyway, and strangers would be heard.
  if (options.time == "stepped" && options.pace == 0.0) {
    if (EnterPrivateNetwork(error)) return true;
    std::cout << "note: " << *error << ": what others send on " << fleet->link.lcm_url
              << " is heard by this run\n";
    error->clear();
  }
  if (std::string taken; !HasMulticastRoute()) {
    if (!EnterOwnNetwork("no multicast route here", *url, interfaces, error)) {
      error->append("; add a route: ip link set dev lo multicast on; ip route add 224.0.0.0/4 dev ");
      error->append(url->ttl > 0 ? "<interface>" : "lo");
      return false;
    }
  } else if (!reservation_.Take(wanted, &taken) && !EnterOwnNetwork(taken, *url, interfaces, error)) {
    error->append("; wait for its end, or give this run other buses and another link.lcm_url");
    return false;
  }
  if (!virtual_can_.Provide(interfaces, error)) return false;
  if (!interfaces.empty()) PrintCanInterfaces(interfaces, virtual_can_.made(), std::cout);
  return true;
}

}  // namespace armada
