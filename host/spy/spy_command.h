#pragma once

#include <string>

namespace armada {

struct SpyOptions {
  std::string file;       ///< fleet or scenario file whose link.lcm_url is watched; empty: lcm_url
  std::string lcm_url;    ///< empty: the default of link.lcm_url
  bool jar_only = false;  ///< make the jar of message types, print its path, and that is all
};

/// `armada spy`: lcm-spy with Armada's message types on a fleet's LCM url. Becomes lcm-spy when all it needs
/// is there; otherwise says on standard error what is missing and how to get it, and returns an exit code.
int RunSpyCommand(const SpyOptions& options);

}  // namespace armada
