#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/can/frame.h"

namespace armada {

/// The user-space bus's datagram: the MessagePack map that python-can (4.1, interface `udp_multicast`) sends
/// for one frame, keys in its order:
///   timestamp float64 [s, wall clock], arbitration_id, is_extended_id, is_remote_frame, is_error_frame,
///   channel nil, dlc, data bin, is_fd, bitrate_switch, error_state_indicator.
/// MessagePack itself: https://github.com/msgpack/msgpack/blob/master/spec.md

/// Larger than any datagram EncodeUdpFrame writes.
inline constexpr size_t kMaxUdpFrameBytes = 320;
using UdpFrameBuffer = std::array<uint8_t, kMaxUdpFrameBytes>;

/// Writes `frame`, byte for byte as python-can would, and returns the number of bytes; 0 for a frame that is
/// not IsValid(). `timestamp_s` is the wall clock.
size_t EncodeUdpFrame(const CanFrame& frame, double timestamp_s, UdpFrameBuffer* buffer);

/// Reads one frame. Keys may come in any order, numbers and strings in any of MessagePack's widths, unknown
/// keys are skipped; timestamp and channel may be missing. False, and `frame` untouched, for anything else: a
/// byte too few or too many, a wrong type, a missing or doubled key, a frame that is not IsValid().
/// `stamp_ns` comes out as 0.
bool DecodeUdpFrame(std::span<const uint8_t> datagram, CanFrame* frame);

}  // namespace armada
