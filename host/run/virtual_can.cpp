#include "host/run/virtual_can.h"

#include <net/if.h>

#include "host/run/ip_command.h"

namespace armada {
namespace {

// CAN FD: the kernel lets FD frames through where they fit (CANFD_MTU of linux/can.h).
constexpr const char* kMtu = "72";

// Reads names until its input is closed, by us or by the kernel when this process has ended in whatever way,
// then removes what has them. In a session of its own: what ends our process group must not end it.
constexpr const char* kJanitor =
    "exec setsid sh -c 'while read -r name; do names=\"$name $names\"; done; "
    "for name in $names; do ip link delete dev \"$name\"; done' 2>/dev/null";

std::string Remedy(const std::vector<std::string>& interfaces) {
  std::string text = "\n  sudo modprobe vcan";
  for (const std::string& name : interfaces) {
    if (VirtualCan::Exists(name)) continue;
    text.append("\n  sudo ip link add dev ").append(name).append(" type vcan");
    text.append(" && sudo ip link set dev ").append(name).append(" mtu ").append(kMtu).append(" up");
  }
  return text + "\nWhere the kernel has no CAN: --bus vm runs the same in a kernel that has it";
}

}  // namespace

VirtualCan::~VirtualCan() {
  if (janitor_ != nullptr) pclose(janitor_);
}

bool VirtualCan::Exists(const std::string& interface_name) {
  return if_nametoindex(interface_name.c_str()) != 0;
}

bool VirtualCan::Provide(const std::vector<std::string>& interfaces, std::string* error) {
  for (const std::string& name : interfaces) {
    std::string complaint;
    if (Exists(name) || Make(name, &complaint)) continue;
    *error = "cannot make the CAN interface ";
    error->append(name).append(": ").append(complaint);
    error->append("\nRun as root, or make what is missing once:").append(Remedy(interfaces));
    return false;
  }
  return true;
}

// The janitor knows of an interface before there is one: nothing can come between.
bool VirtualCan::Make(const std::string& interface_name, std::string* complaint) {
  if (janitor_ == nullptr) janitor_ = popen(kJanitor, "we");
  if (janitor_ == nullptr || std::fprintf(janitor_, "%s\n", interface_name.c_str()) < 0 ||
      std::fflush(janitor_) != 0) {
    *complaint = "cannot start sh, which would remove it after the run";
    return false;
  }
  if (!RunIp({"link", "add", "dev", interface_name, "type", "vcan"}, complaint) ||
      !RunIp({"link", "set", "dev", interface_name, "mtu", kMtu, "up"}, complaint)) {
    return false;
  }
  made_.push_back(interface_name);
  return true;
}

}  // namespace armada
