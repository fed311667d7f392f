#pragma once

#include <string>

namespace armada {

enum class MulticastRoute { kYes, kNo };

/// Moves this process into a network of its own, with nothing but the loopback interface, up and able to
/// multicast, and with or without a route for multicast groups over it. Nothing to clean up: it goes with the
/// process. Empty on success, else what failed.
std::string EnterPrivateNetwork(MulticastRoute route);

}  // namespace armada
