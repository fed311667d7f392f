#include "host/run/board_networks.h"

#include <sched.h>
#include <sys/mount.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstring>

#include "host/run/ip_command.h"

namespace armada {
namespace {

constexpr const char* kNames = "/run/netns";  // where ip(8) keeps the names of namespaces
constexpr const char* kBridge = "armada-lan";
constexpr const char* kSubnet = "10.74.163.";  // seen by no one outside
constexpr const char* kMulticast = "224.0.0.0/4";
constexpr const char* kCanFdMtu = "72";

std::string BoardName(int arm_id) {
  return "board" + std::to_string(arm_id);
}

std::string AddressOf(int host) {
  return kSubnet + std::to_string(host) + "/24";
}

bool RunAll(const std::vector<std::vector<std::string>>& commands, std::string* error) {
  for (const auto& command : commands) {
    if (RunIp(command, error)) continue;
    std::string line = "ip";
    for (const std::string& word : command) line.append(" ").append(word);
    *error = "boards in namespaces: " + line + ": " + *error;
    return false;
  }
  return true;
}

}  // namespace

// The tmpfs over the names is seen by this process and its children only, so that they cannot clash with
// others'.
bool BoardNetworks::Enter(std::string* error) {
  if (unshare(CLONE_NEWNET | CLONE_NEWNS) != 0) {
    *error = std::string("--namespaces: cannot make namespaces (") + std::strerror(errno) +
             "); run as root, or with --bus vm";
    return false;
  }
  mkdir(kNames, 0755);
  if (mount("none", "/", nullptr, MS_REC | MS_SLAVE, nullptr) != 0 ||
      mount("armada", kNames, "tmpfs", 0, nullptr) != 0) {
    *error = std::string("--namespaces: cannot mount ") + kNames + ": " + std::strerror(errno);
    return false;
  }
  return RunAll({{"link", "set", "dev", "lo", "up"},
                 {"link", "add", "dev", kBridge, "type", "bridge", "mcast_snooping", "0"},
                 {"address", "add", AddressOf(254), "dev", kBridge},
                 {"link", "set", "dev", kBridge, "up"},
                 {"route", "add", kMulticast, "dev", kBridge}},
                error);
}

bool BoardNetworks::Add(int arm_id, const std::string& can_interface, std::string* error) {
  const std::string board = BoardName(arm_id);
  const std::string port = "lan" + std::to_string(arm_id);
  return RunAll(
      {{"netns", "add", board},
       {"link", "add", "dev", port, "type", "veth", "peer", "name", "lan", "netns", board},
       {"link", "set", "dev", port, "master", kBridge, "up"},
       {"-n", board, "link", "set", "dev", "lo", "up"},
       {"-n", board, "address", "add", AddressOf(++boards_), "dev", "lan"},
       {"-n", board, "link", "set", "dev", "lan", "up"},
       {"-n", board, "route", "add", kMulticast, "dev", "lan"},
       {"link", "add", "dev", can_interface, "type", "vxcan", "peer", "name", can_interface, "netns", board},
       {"link", "set", "dev", can_interface, "mtu", kCanFdMtu, "up"},
       {"-n", board, "link", "set", "dev", can_interface, "mtu", kCanFdMtu, "up"}},
      error);
}

std::vector<std::string> BoardNetworks::Prefix(int arm_id) {
  return {"/sbin/ip", "netns", "exec", BoardName(arm_id)};
}

}  // namespace armada
