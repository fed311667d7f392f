#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <utility>

namespace armada {

// Names of the kinds that a configuration chooses between. An overload of EnumNames beside the kind, found by
// its namespace, is all that a kind needs in order to be read, written and documented. A kind without a name
// means that none was chosen.

template <class Enum>
using EnumName = std::pair<Enum, std::string_view>;

template <class Enum>
concept NamedEnum = requires(Enum value) {
  EnumNames(value).front().second;
};

template <NamedEnum Enum>
constexpr std::string_view NameOf(Enum value) {
  for (const auto& [candidate, name] : EnumNames(value)) {
    if (candidate == value) return name;
  }
  return "?";
}

template <NamedEnum Enum>
constexpr std::optional<Enum> EnumNamed(std::string_view name) {
  for (const auto& [candidate, its_name] : EnumNames(Enum{})) {
    if (its_name == name) return candidate;
  }
  return std::nullopt;
}

}  // namespace armada
