#include "firmware/can/frame_time.h"

namespace armada {
namespace {

/// At worst one stuff bit after the first five bits and then one after every four.
constexpr int Stuffed(int bits) {
  return bits + (bits - 1) / 4;
}

constexpr int kAfterCrc = 2 + 7 + 3;  // acknowledgement, end of frame, intermission: never stuffed

double ClassicTime_s(const CanFrame& frame, double bitrate_bit_s) {
  const int header = frame.extended ? 39 : 19;  // start, arbitration and control
  const int data = frame.remote ? 0 : 8 * frame.length;
  return (Stuffed(header + data + 15) + 1 + kAfterCrc) / bitrate_bit_s;  // CRC of 15 bits, and its delimiter
}

// The rate changes at the bit-rate switch bit and back at the CRC delimiter.
double FdTime_s(const CanFrame& frame, const CanBusConfig& bus) {
  const int header = frame.extended ? 36 : 17;  // start to bit-rate switch
  const int data = 5 + 8 * frame.length;        // error state indicator, length, data
  const int crc = frame.length > 16 ? 21 : 17;
  const int checked = 4 + crc;                   // stuff count and CRC, with fixed stuff bits:
  const int tail = checked + (checked + 3) / 4;  // one before, and one after every four
  const int arbitration = Stuffed(header + data) - Stuffed(data) + 1 + kAfterCrc;
  const double data_rate_bit_s = frame.bitrate_switch ? bus.data_bitrate_bit_s : bus.bitrate_bit_s;
  return arbitration / bus.bitrate_bit_s + (Stuffed(data) + tail) / data_rate_bit_s;
}

}  // namespace

double WorstFrameTime_s(const CanFrame& frame, const CanBusConfig& bus) {
  return frame.fd ? FdTime_s(frame, bus) : ClassicTime_s(frame, bus.bitrate_bit_s);
}

}  // namespace armada
