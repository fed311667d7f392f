#pragma once

namespace armada {

/// Settings of an ODrive that its CANSimple does not tell.
struct ODriveConfig {
  double heartbeat_s = 0.1;

  template <class Visitor>
  void Visit(Visitor& parameter) {
    parameter({"heartbeat_s", "s", 0.01, 10,
               "period of the drive's heartbeat, as it is set there (heartbeat_rate_ms)"},
              heartbeat_s);
  }
};

}  // namespace armada
