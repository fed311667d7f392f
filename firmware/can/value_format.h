#pragma once

#include <cstdint>
#include <cstdio>
#include <string>

namespace armada {

/// "0x1a0" or, with a width, "0x01a0". For messages to people: it allocates.
inline std::string Hexadecimal(uint32_t value, int digits = 1) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%0*x", digits, static_cast<unsigned>(value));
  return text;
}

}  // namespace armada
