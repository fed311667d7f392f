#include "firmware/app/config/value_text.h"

#include <array>
#include <charconv>
#include <cmath>

namespace armada {

std::string ValueText(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

std::string RoundedText(double value) {
  return ValueText(std::round(value * 1e3) / 1e3);
}

std::string ValueText(std::string_view value) {
  constexpr std::string_view kHex = "0123456789abcdef";
  std::string text = "\"";
  for (const char c : value) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      text += '\\';
      text += c;
    } else if (code < 0x20 || code == 0x7f) {
      text += "\\u00";
      text += kHex[code >> 4];
      text += kHex[code & 15];
    } else {
      text += c;
    }
  }
  return text + '"';
}

}  // namespace armada
