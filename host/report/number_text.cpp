#include "host/report/number_text.h"

#include <charconv>
#include <cmath>
#include <string_view>

namespace armada {
namespace {

template <typename... Format>
std::string ToText(double value, Format... format) {
  char buffer[400];  // the longest double in fixed notation has 310 digits before the point
  const auto [end, status] = std::to_chars(buffer, buffer + sizeof(buffer), value, format...);
  return {buffer, end};
}

std::string Superscript(int exponent) {
  static constexpr std::string_view kDigits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = exponent < 0 ? "⁻" : "";
  for (const char digit : std::to_string(std::abs(exponent))) text += kDigits[digit - '0'];
  return text;
}

}  // namespace

std::string NumberText(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  if (value == 0.0) return "0";
  const std::string scientific = ToText(value, std::chars_format::scientific, digits - 1);
  const size_t e = scientific.find('e');
  const int exponent = std::stoi(scientific.substr(e + 1));
  if (exponent < -3 || exponent > 6) return scientific.substr(0, e) + "×10" + Superscript(exponent);
  return ToText(value, std::chars_format::fixed, std::max(0, digits - 1 - exponent));
}

std::string ShortNumber(double value) {
  std::string text = NumberText(value);
  if (text.find("×") != std::string::npos || text.find('.') == std::string::npos) return text;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

std::string GnuplotNumber(double value) {
  return ToText(value, std::chars_format::general, 6);
}

}  // namespace armada
