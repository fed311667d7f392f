#pragma once

#include "firmware/core/parameter.h"

namespace armada {

/// Settings of an ODrive that its CANSimple does not tell.
struct ODriveConfig {
  double heartbeat_s = 0.1;
  double heartbeat_timeout_s = 0.35;

  void Visit(ParameterVisitor& parameter) {
    parameter({"heartbeat_s", "s", 0.01, 10,
               "period of the drive's heartbeat, as it is set there (heartbeat_rate_ms)"},
              heartbeat_s);
    parameter({"heartbeat_timeout_s", "s", 0.01, 60, "time without one after which the drive counts as lost"},
              heartbeat_timeout_s);
  }
};

}  // namespace armada
