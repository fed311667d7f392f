#pragma once

#include <array>
#include <cstdint>

namespace armada {

/// One CAN frame, classic or FD, as it is on the wire plus the time it was received.
struct CanFrame {
  uint32_t id = 0;        ///< 11 bits, or 29 when `extended`
  bool extended = false;  ///< 29-bit identifier
  bool remote = false;    ///< remote transmission request: asks for the frame with this id, carries no data
  bool error = false;     ///< error frame of the controller, not of a node
  bool fd = false;        ///< CAN FD
  bool bitrate_switch = false;
  bool error_state_indicator = false;
  /// Not on the wire. While it waits to be sent, a newer frame with the same identifier and this mark takes
  /// its place: of torques only the latest counts.
  bool latest_only = false;
  uint8_t length = 0;  ///< bytes used in `data`; for a remote frame, the length asked for
  std::array<uint8_t, 64> data{};
  int64_t stamp_ns = 0;  ///< CLOCK_MONOTONIC at reception; 0 for a frame not received from a bus
};

/// True for a frame that a CAN bus can carry: identifier in range, a length that its kind has, flags that go
/// together.
constexpr bool IsValid(const CanFrame& frame) {
  if (frame.id > (frame.extended ? 0x1FFF'FFFFu : 0x7FFu)) return false;
  if (!frame.fd) {
    return frame.length <= 8 && !frame.bitrate_switch && !frame.error_state_indicator &&
           !(frame.remote && frame.error);
  }
  if (frame.remote) return false;
  const int length = frame.length;  // the 16 lengths of CAN FD
  return length <= 8 || (length <= 24 && length % 4 == 0) || length == 32 || length == 48 || length == 64;
}

}  // namespace armada
