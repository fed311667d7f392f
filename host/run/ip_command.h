#pragma once

#include <string>
#include <vector>

namespace armada {

/// Runs ip(8) of iproute2 with these arguments, without a shell. False when it failed, and then `complaint`
/// is what it said, in one line.
bool RunIp(const std::vector<std::string>& arguments, std::string* complaint);

}  // namespace armada
