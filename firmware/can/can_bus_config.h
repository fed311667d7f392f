#pragma once

#include <vector>

#include "firmware/can/can_filter.h"
#include "firmware/core/parameter.h"

namespace armada {

/// How an arm's bus is set up. For buses of the kernel; the user-space bus has no bit timing and no queues,
/// and only `armada check` reads these of it.
struct CanBusConfig {
  double bitrate_bit_s = 1e6;
  double data_bitrate_bit_s = 5e6;
  int transmit_window = 4;
  int tx_queue_length_max = 32;

  void Visit(ParameterVisitor& parameter) {
    parameter({"bitrate_bit_s", "bit/s", 1e4, 1e6, "bit rate; the interface must be set to it"},
              bitrate_bit_s);
    parameter({"data_bitrate_bit_s", "bit/s", 1e5, 8e6, "CAN FD: bit rate of the data, likewise"},
              data_bitrate_bit_s);
    parameter({"transmit_window", "frames", 1, 32,
               "frames handed to the kernel and not yet seen on the wire; further ones wait where newer "
               "torques replace them"},
              transmit_window);
    parameter({"tx_queue_length_max", "frames", 1, 10000,
               "longest transmit queue (txqueuelen) that a controller's interface may have"},
              tx_queue_length_max);
  }
};

/// What a program wants of a bus.
struct BusOptions {
  CanBusConfig config;
  bool fd = false;                 ///< send and receive CAN FD frames, too
  std::vector<CanFilter> filters;  ///< frames to receive, own ones included; none: all
};

}  // namespace armada
