#include "host/run/run_reservation.h"

#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <cstddef>
#include <string_view>

#include "firmware/can/bus_name.h"
#include "firmware/link/lcm_url.h"

namespace armada {
namespace {

constexpr std::string_view kPrefix = "armada-run ";

// In the abstract name space a name begins with a zero byte, and ends with the address.
struct Address {
  explicit Address(const std::string& name) {
    socket.sun_family = AF_UNIX;
    char* const room = socket.sun_path + 1;
    const size_t capacity = sizeof socket.sun_path - 1;
    size_t length = kPrefix.copy(room, capacity);
    length += name.copy(room + length, capacity - length);
    size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + length);
  }
  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&socket); }

  sockaddr_un socket{};
  socklen_t size = 0;
};

UniqueFd NewSocket() {
  return UniqueFd(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
}

// The process that listens there; 0 when it is gone or cannot be seen from here.
pid_t HolderOf(const Address& address) {
  const UniqueFd asking = NewSocket();
  ucred peer{};
  socklen_t size = sizeof peer;
  if (connect(asking.get(), address.get(), address.size) != 0 ||
      getsockopt(asking.get(), SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) {
    return 0;
  }
  return peer.pid;
}

}  // namespace

bool RunReservation::Take(const std::vector<std::string>& names, std::string* taken) {
  constexpr int kAsking = 16;  // that may ask for the holder
  sockets_.clear();
  for (const std::string& name : names) {
    const Address address(name);
    UniqueFd socket = NewSocket();
    if (bind(socket.get(), address.get(), address.size) != 0 || listen(socket.get(), kAsking) != 0) {
      const pid_t holder = HolderOf(address);
      *taken = name + " is in use by another run" +
               (holder > 0 ? " (process " + std::to_string(holder) + ")" : "");
      sockets_.clear();
      return false;
    }
    sockets_.push_back(std::move(socket));
  }
  return true;
}

std::vector<std::string> NamesToReserve(const FleetConfig& fleet, const std::vector<std::string>& hil_buses) {
  // However it is spelt, a place is one.
  std::string ignored;
  const auto url = ParseLcmUrl(fleet.link.lcm_url, &ignored);
  const std::string link = url ? ToString(*url) : fleet.link.lcm_url;
  std::vector<std::string> names = {link.substr(0, link.find('?'))};
  const auto add = [&](const std::string& text) {
    const auto bus = ParseBusName(text, &ignored);
    const bool udp = bus && bus->kind == BusKind::kUdp;
    const std::string name = udp ? "udp:" + bus->group + ":" + std::to_string(bus->port) : text;
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const ArmEntry& arm : fleet.arms) add(arm.bus);
  for (const std::string& text : hil_buses) add(text.substr(text.find('=') + 1));
  return names;
}

}  // namespace armada
