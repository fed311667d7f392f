#pragma once

#include <concepts>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/core/named_enum.h"

namespace armada {

// A configuration value in TOML's notation, which for every value here is JSON's, too. Numbers are the
// shortest text that reads back to the same value.

std::string ValueText(double value);
std::string ValueText(std::string_view value);
inline std::string ValueText(const std::string& value) {
  return ValueText(std::string_view(value));
}
inline std::string ValueText(std::same_as<bool> auto value) {
  return value ? "true" : "false";
}
inline std::string ValueText(std::same_as<int> auto value) {
  return std::to_string(value);
}

template <NamedEnum Enum>
std::string ValueText(Enum value) {
  return ValueText(std::string_view(NameOf(value)));
}

template <class Element>
std::string ValueText(const std::vector<Element>& values) {
  std::string text = "[";
  for (const Element& value : values) {
    if (text.size() > 1) text += ", ";
    text += ValueText(value);
  }
  return text + "]";
}

/// To three decimals, for messages.
std::string RoundedText(double value);

}  // namespace armada
