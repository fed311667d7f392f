#include "tests/can/private_network.h"

#include <arpa/inet.h>
#include <net/if.h>
#include <net/route.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "firmware/unique_fd.h"

namespace armada {
namespace {

std::string Failed(const char* step) {
  return std::string(step) + ": " + std::strerror(errno);
}

sockaddr Address(const char* dotted) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  inet_pton(AF_INET, dotted, &address.sin_addr);
  sockaddr generic{};
  std::memcpy(&generic, &address, sizeof generic);
  return generic;
}

}  // namespace

std::string EnterPrivateNetwork(MulticastRoute route) {
  // Who may not make a network may make a user namespace first, in which it may.
  if (unshare(CLONE_NEWNET) != 0 && unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) return Failed("unshare");
  const UniqueFd control(socket(AF_INET, SOCK_DGRAM, 0));
  char loopback[] = "lo";
  ifreq request{};
  std::strncpy(request.ifr_name, loopback, IFNAMSIZ - 1);
  request.ifr_flags = IFF_UP | IFF_MULTICAST;
  if (ioctl(control.get(), SIOCSIFFLAGS, &request) != 0) return Failed("set lo up");
  if (route == MulticastRoute::kNo) return {};
  rtentry entry{};
  entry.rt_dst = Address("224.0.0.0");
  entry.rt_genmask = Address("240.0.0.0");
  entry.rt_flags = RTF_UP;
  entry.rt_dev = loopback;
  if (ioctl(control.get(), SIOCADDRT, &entry) != 0) return Failed("add the multicast route");
  return {};
}

}  // namespace armada
