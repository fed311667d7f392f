#include <algorithm>

#include "firmware/can/msgpack.h"
#include "firmware/can/udp_frame_codec.h"
#include "tests/fuzz/require.h"

namespace armada {
namespace {

bool SameOnTheWire(const CanFrame& a, const CanFrame& b) {
  const size_t bytes = a.remote ? 0 : a.length;
  return a.id == b.id && a.extended == b.extended && a.remote == b.remote && a.error == b.error &&
         a.fd == b.fd && a.bitrate_switch == b.bitrate_switch &&
         a.error_state_indicator == b.error_state_indicator && a.length == b.length &&
         std::equal(a.data.begin(), a.data.begin() + bytes, b.data.begin());
}

/// Datagrams of the user-space bus: what is read is a frame that a bus can carry, and survives being written
/// and read again.
void TestDatagram(std::span<const uint8_t> datagram) {
  MsgpackReader values(datagram);
  while (!values.at_end() && values.Skip()) {
  }
  CanFrame frame;
  if (!DecodeUdpFrame(datagram, &frame)) return;
  Require(IsValid(frame), "a frame that was read is valid");
  Require(frame.stamp_ns == 0, "a datagram tells no time of reception");
  UdpFrameBuffer buffer;
  const size_t size = EncodeUdpFrame(frame, 0.0, &buffer);
  Require(size > 0 && size < buffer.size(), "a valid frame can be written, with room to spare");
  CanFrame again;
  Require(DecodeUdpFrame(std::span(buffer).first(size), &again), "what was written can be read");
  Require(SameOnTheWire(frame, again), "writing and reading change nothing");
}

}  // namespace
}  // namespace armada

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  armada::TestDatagram({data, size});
  return 0;
}
