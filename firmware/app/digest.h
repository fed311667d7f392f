#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace armada {

/// FNV-1a, 64 bits, as 16 hexadecimal digits: tells texts apart, guards against nobody.
inline std::string Digest(std::string_view text) {
  constexpr char kDigits[] = "0123456789abcdef";
  uint64_t hash = 0xcbf29ce484222325;
  for (const char c : text) hash = (hash ^ static_cast<uint8_t>(c)) * 0x100000001b3;
  std::string digits;
  for (int shift = 60; shift >= 0; shift -= 4) digits += kDigits[(hash >> shift) & 0xF];
  return digits;
}

}  // namespace armada
