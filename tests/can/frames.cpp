#include "tests/can/frames.h"

#include <algorithm>
#include <array>
#include <cstdio>

namespace armada {

CanFrame DataFrame(uint32_t id, std::initializer_list<uint8_t> data) {
  CanFrame frame;
  frame.id = id;
  frame.length = static_cast<uint8_t>(data.size());
  std::copy(data.begin(), data.end(), frame.data.begin());
  return frame;
}

CanFrame RandomFrame(std::mt19937_64* random) {
  constexpr std::array<uint8_t, 16> kFdLengths = {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};
  const uint64_t bits = (*random)();
  CanFrame frame;
  frame.extended = bits & 1;
  frame.id = static_cast<uint32_t>((*random)()) & (frame.extended ? 0x1FFF'FFFFu : 0x7FFu);
  frame.fd = bits & 2;
  if (frame.fd) {
    frame.bitrate_switch = bits & 4;
    frame.error_state_indicator = bits & 8;
    frame.length = kFdLengths[bits >> 8 & 15];
  } else {
    frame.remote = (bits >> 16 & 3) == 0;
    frame.error = !frame.remote && (bits >> 18 & 7) == 0;
    frame.length = static_cast<uint8_t>((bits >> 8) % 9);
  }
  const size_t size = frame.remote ? 0 : frame.length;
  for (size_t i = 0; i < size; ++i) frame.data[i] = static_cast<uint8_t>((*random)());
  return frame;
}

std::string Describe(const CanFrame& frame) {
  std::string text = std::to_string(frame.id);
  for (const bool flag : {frame.extended, frame.remote, frame.error, frame.fd, frame.bitrate_switch,
                          frame.error_state_indicator}) {
    text += flag ? " 1" : " 0";
  }
  text += ' ';
  text += std::to_string(frame.length);
  text += ' ';
  const size_t size = frame.remote ? 0 : frame.length;
  if (size == 0) text += '-';
  for (size_t i = 0; i < size; ++i) {
    char byte[3];
    std::snprintf(byte, sizeof byte, "%02x", static_cast<unsigned>(frame.data[i]));
    text += byte;
  }
  return text;
}

std::vector<uint8_t> FromHex(const std::string& hex) {
  std::vector<uint8_t> bytes;
  for (size_t i = 0; i + 1 < hex.size(); i += 2) {
    bytes.push_back(static_cast<uint8_t>(std::stoul(hex.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

}  // namespace armada
