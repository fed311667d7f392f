#pragma once

#include <string>

namespace armada {

/// Sets a network interface up or down, as `ip link set dev NAME up` does, without the time that a program
/// takes to start. False, and the reason in `error`, when the kernel refuses.
bool SetLinkUp(const std::string& interface_name, bool up, std::string* error);

}  // namespace armada
