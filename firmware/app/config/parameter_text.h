#pragma once

#include <cmath>
#include <concepts>
#include <string>
#include <vector>

#include "firmware/app/config/parameter_reader.h"
#include "firmware/app/config/value_text.h"

namespace armada {

// What a parameter's documentation says of its values.

/// The legal values.
inline std::string AllowedText(const ParameterInfo& info, double) {
  return NumbersText(info);
}
inline std::string AllowedText(const ParameterInfo& info, std::same_as<int> auto) {
  return NumbersText(info);
}
inline std::string AllowedText(const ParameterInfo&, std::same_as<bool> auto) {
  return "true, false";
}
inline std::string AllowedText(const ParameterInfo&, const std::string&) {
  return "text";
}
inline std::string AllowedText(const ParameterInfo& info, const std::vector<std::vector<double>>&) {
  return "list of points, each number " + NumbersText(info);
}
inline std::string AllowedText(const ParameterInfo& info, const std::vector<int>&) {
  return "list, each " + NumbersText(info);
}
template <int kMaxRows>
std::string AllowedText(const ParameterInfo& info, const BoundedVector<kMaxRows>&) {
  return NumbersText(info) + ", or a list";
}
template <NamedEnum Enum>
std::string AllowedText(const ParameterInfo&, Enum kind) {
  return AllNames(kind);
}

/// "required" and "none" are no values: a key that must be given, and one that may be left out.
template <class T>
std::string DefaultText(const ParameterInfo& info, const T& value) {
  if (IsRequired(info, value)) return "required";
  if constexpr (requires { value.size(); }) {
    if (value.size() == 0) return "none";
  } else if constexpr (std::same_as<T, double>) {
    if (std::isnan(value)) return "none";
  }
  return ValueText(value);
}

}  // namespace armada
