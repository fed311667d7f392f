#include "host/private_network.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <net/if.h>
#include <net/route.h>
#include <netinet/in.h>
#include <poll.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "firmware/unique_fd.h"

namespace armada {
namespace {

sockaddr_in Address(const char* dotted) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  inet_pton(AF_INET, dotted, &address.sin_addr);
  return address;
}

bool WriteFile(const char* path, const std::string& text) {
  const UniqueFd file(open(path, O_WRONLY | O_CLOEXEC));
  return write(file.get(), text.data(), text.size()) == static_cast<ssize_t>(text.size());
}

bool Fail(const std::string& what, std::string* error) {
  *error = "private network: " + what + ": " + std::strerror(errno);
  return false;
}

bool UnshareNetwork(std::string* error) {
  if (unshare(CLONE_NEWNET) == 0) return true;
  if (errno != EPERM) return Fail("cannot make a network namespace", error);

  const std::string user = std::to_string(geteuid());
  const std::string group = std::to_string(getegid());
  if (unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) {
    const char* hint = errno == EINVAL
                           ? "the process has threads already, a namespace must be entered before"
                           : "this kernel lets only root make namespaces; run as root, or make a route "
                             "with `ip link set lo up multicast on; ip route add 224.0.0.0/4 dev lo`";
    return Fail(hint, error);
  }
  // The user stays who it was. The kernel wants setgroups given up before an unprivileged user maps a group.
  if (!WriteFile("/proc/self/setgroups", "deny") ||
      !WriteFile("/proc/self/uid_map", user + " " + user + " 1") ||
      !WriteFile("/proc/self/gid_map", group + " " + group + " 1")) {
    return Fail("cannot map the user into its namespace", error);
  }
  return true;
}

// ip link set lo up multicast on; ip route add 224.0.0.0/4 dev lo
bool RouteMulticastToLoopback(std::string* error) {
  char name[] = "lo";
  const UniqueFd control(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  ifreq interface {};
  std::memcpy(interface.ifr_name, name, sizeof(name));
  if (ioctl(control.get(), SIOCGIFFLAGS, &interface) != 0) return Fail("cannot read the state of lo", error);
  interface.ifr_flags = static_cast<short>(interface.ifr_flags | IFF_UP | IFF_MULTICAST);
  if (ioctl(control.get(), SIOCSIFFLAGS, &interface) != 0) return Fail("cannot bring lo up", error);

  rtentry route{};
  const sockaddr_in destination = Address("224.0.0.0");
  const sockaddr_in mask = Address("240.0.0.0");
  std::memcpy(&route.rt_dst, &destination, sizeof(destination));
  std::memcpy(&route.rt_genmask, &mask, sizeof(mask));
  route.rt_flags = RTF_UP;
  route.rt_dev = name;
  if (ioctl(control.get(), SIOCADDRT, &route) != 0) return Fail("cannot route multicast to lo", error);
  return true;
}

}  // namespace

bool HasMulticastRoute() {
  constexpr int kPatience_ms = 2000;  // a kernel under load delivers late
  constexpr std::array<char, 7> kProbe = {'a', 'r', 'm', 'a', 'd', 'a', '?'};

  sockaddr_in group = Address("239.255.76.67");
  auto* address = reinterpret_cast<sockaddr*>(&group);
  socklen_t size = sizeof(group);
  const ip_mreq membership{group.sin_addr, {htonl(INADDR_ANY)}};
  const int ttl = 0;

  // The kernel picks a free port, so that the probe disturbs no one.
  const UniqueFd socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (bind(socket.get(), address, size) != 0 || getsockname(socket.get(), address, &size) != 0 ||
      setsockopt(socket.get(), IPPROTO_IP, IP_MULTICAST_TTL, &ttl, sizeof(ttl)) != 0 ||
      setsockopt(socket.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof(membership)) != 0 ||
      sendto(socket.get(), kProbe.data(), kProbe.size(), 0, address, size) < 0) {
    return false;
  }
  pollfd waiting{socket.get(), POLLIN, 0};
  if (poll(&waiting, 1, kPatience_ms) != 1) return false;
  std::array<char, kProbe.size()> heard{};
  return recv(socket.get(), heard.data(), heard.size(), 0) == static_cast<ssize_t>(kProbe.size()) &&
         heard == kProbe;
}

bool EnterPrivateNetwork(std::string* error) {
  return UnshareNetwork(error) && RouteMulticastToLoopback(error);
}

}  // namespace armada
