#pragma once

#include <string>
#include <vector>

namespace armada {

/// A definition of an LCM message.
struct MessageType {
  std::string file;  ///< "estimate_t.lcm"
  std::string text;  ///< what the file holds
};

/// The files of lcmtypes/ as they were when this program was built.
std::vector<MessageType> EmbeddedTypes();

}  // namespace armada
