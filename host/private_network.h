#pragma once

#include <string>

namespace armada {

/// Whether a process here can send to a multicast group and hear it. It tries: joins a group, sends itself a
/// datagram that does not leave the host, and waits for it, at most 0.2 s.
bool HasMulticastRoute();

/// Moves this process and its future children into a network of their own, whose loopback carries multicast;
/// nothing outside is changed, and nothing is left behind when the last of them ends. Root is not needed
/// where the kernel lets users make namespaces. Call it before any thread starts. On failure sets `*error` to
/// the reason and what to do.
bool EnterPrivateNetwork(std::string* error);

}  // namespace armada
