#include "host/run/link_switch.h"

#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

#include "firmware/unique_fd.h"

namespace armada {

bool SetLinkUp(const std::string& interface_name, bool up, std::string* error) {
  const UniqueFd any(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));  // of whatever kind
  ifreq request{};
  interface_name.copy(request.ifr_name, IFNAMSIZ - 1);
  if (any.valid() && ioctl(any.get(), SIOCGIFFLAGS, &request) == 0) {
    const int flags = request.ifr_flags;
    request.ifr_flags = static_cast<short>(up ? flags | IFF_UP : flags & ~IFF_UP);
    if (ioctl(any.get(), SIOCSIFFLAGS, &request) == 0) return true;
  }
  *error = "cannot set " + interface_name + (up ? " up: " : " down: ") + std::strerror(errno);
  return false;
}

}  // namespace armada
