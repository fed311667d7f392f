#pragma once

#include <string>
#include <vector>

namespace armada {

/// A network namespace for each board, as if it were a computer of its own. Its CAN is one end of a vxcan
/// pair, of the same name on both ends; its Ethernet is a veth pair to a bridge, over which LCM's multicast
/// goes. The other ends are with this process, which moves to a namespace of its own first. All of it, the
/// names of the namespaces included, ends with the last process in it, however that ends.
class BoardNetworks {
 public:
  /// Moves this process. Needs root and has to come before any thread starts.
  bool Enter(std::string* error);

  /// A board whose CAN interface is `can_interface`.
  bool Add(int arm_id, const std::string& can_interface, std::string* error);

  /// The words before a command that make it run on that board.
  static std::vector<std::string> Prefix(int arm_id);

 private:
  int boards_ = 0;
};

}  // namespace armada
