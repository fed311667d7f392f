#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "firmware/core/named_enum.h"

namespace armada {

/// A kind chosen by its name, whatever its enum.
struct Choice {
  struct Name {
    int value;
    std::string_view name;
  };

  int value = 0;
  std::span<const Name> names;
};

/// Names of an enum as those of a Choice.
template <NamedEnum Enum>
inline constexpr auto kChoiceNames = [] {
  constexpr auto kNames = EnumNames(Enum{});
  std::array<Choice::Name, kNames.size()> names{};
  for (size_t i = 0; i < names.size(); ++i) names[i] = {static_cast<int>(kNames[i].first), kNames[i].second};
  return names;
}();

/// A vector of the controller, whatever its maximum size. One value may stand for all.
struct NumberList {
  std::vector<double> values;
  size_t max_count = 0;
};

/// What a parameter is: the types that a member of a Config struct can have.
using ParameterValue = std::variant<bool*, int*, double*, std::string*, Choice*, NumberList*,
                                    std::vector<int>*, std::vector<std::vector<double>>*>;

}  // namespace armada
