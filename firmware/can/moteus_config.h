#pragma once

namespace armada {

/// Wiring of a moteus controller.
struct MoteusConfig {
  int source_id = 0;  ///< the master's address, which answers go to; no drive's node_id

  template <class Visitor>
  void Visit(Visitor& parameter) {
    parameter({"source_id", "", 0, 127, "address of the master"}, source_id);
  }
};

}  // namespace armada
