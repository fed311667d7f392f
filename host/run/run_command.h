#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/scenario_arguments.h"

namespace armada {

struct RunOptions {
  ScenarioArguments scenario;
  std::string bus = "udp";             ///< udp, socketcan or vm
  bool namespaces = false;             ///< socketcan: each board in a network namespace of its own
  std::vector<std::string> hil_buses;  ///< passed to armada-hil as --bus
  std::string time = "real";           ///< real or stepped
  double pace = 1.0;                   ///< stepped: seconds of the run a real one; 0: as fast as it goes
  uint64_t seed = 1;
  std::string out = "out/run";
  std::string json;
  std::string program_directory;  ///< where armada-arm, armada-hil and armada-leader are
};

/// `armada run`: the scenario as processes, in real time or in stepped time. Starts, watches and stops
/// everything; exit code.
int RunRunCommand(const RunOptions& options);

}  // namespace armada
