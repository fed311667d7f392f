#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace armada {

/// The bytes as people write them, two digits each.
inline std::string Hex(std::span<const uint8_t> bytes) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const uint8_t byte : bytes) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 0xF];
  }
  return text;
}

}  // namespace armada
