#include "tests/drives/cia402_bytes.h"

#include <cstdio>

namespace armada {

CanFrame Frame(const std::string& text) {
  const size_t sign = text.find('#');
  CanFrame frame;
  frame.id = static_cast<uint32_t>(std::stoul(text.substr(0, sign), nullptr, 16));
  frame.extended = sign == 8;
  frame.remote = text.substr(sign + 1) == "R";
  for (size_t i = sign + 1; !frame.remote && i < text.size(); i += 2) {
    frame.data[frame.length++] = static_cast<uint8_t>(std::stoul(text.substr(i, 2), nullptr, 16));
  }
  return frame;
}

std::string Text(const CanFrame& frame) {
  char part[12];
  std::snprintf(part, sizeof part, frame.extended ? "%08X#" : "%03X#", static_cast<unsigned>(frame.id));
  std::string text = part;
  if (frame.remote) return text + "R";
  for (size_t i = 0; i < frame.length; ++i) {
    std::snprintf(part, sizeof part, "%02X", static_cast<unsigned>(frame.data[i]));
    text += part;
  }
  return text;
}

}  // namespace armada
