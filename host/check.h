#pragma once

#include <string>
#include <vector>

namespace armada {

struct CheckOptions {
  std::string path;               ///< a fleet file or a scenario
  std::vector<std::string> sets;  ///< `key=value` on top of it
  bool json = false;
  std::string explain{};  ///< only explains the parameters whose keys have this in them
};

/// `armada check`: loads, checks, and writes the result to standard output and mistakes of the configuration
/// to standard error. Returns the exit code: 0, also with warnings; 1 when the task cannot be done as
/// configured; 78 when the configuration breaks a rule.
int RunCheck(const CheckOptions& options);

}  // namespace armada
