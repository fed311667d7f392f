#pragma once

#include "firmware/core/parameter.h"

namespace armada {

/// Wiring of a moteus controller.
struct MoteusConfig {
  int source_id = 0;  ///< the master's address, which answers go to; no drive's node_id

  void Visit(ParameterVisitor& parameter) {
    parameter({"source_id", "", 0, 127, "address of the master"}, source_id);
  }
};

}  // namespace armada
