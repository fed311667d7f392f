#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace armada {

/// FNV-1a, 64 bits: tells texts apart, guards against nobody.
constexpr uint64_t Fnv1a(std::string_view text) {
  uint64_t hash = 0xcbf29ce484222325;
  for (const char c : text) hash = (hash ^ static_cast<uint8_t>(c)) * 0x100000001b3;
  return hash;
}

/// The same as 16 hexadecimal digits.
inline std::string Digest(std::string_view text) {
  constexpr char kDigits[] = "0123456789abcdef";
  const uint64_t hash = Fnv1a(text);
  std::string digits;
  for (int shift = 60; shift >= 0; shift -= 4) digits += kDigits[(hash >> shift) & 0xF];
  return digits;
}

}  // namespace armada
