#pragma once

#include <cstdio>
#include <string>

namespace armada {

/// A number in the words of printf: NumberAs("%.2f rad/s", speed).
inline std::string NumberAs(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

}  // namespace armada
