#pragma once

#include <string>
#include <vector>

#include "firmware/core/parameter.h"

namespace armada {

/// A parameter as a run uses it, and what its documentation says.
struct EffectiveValue {
  std::string key;       ///< full dotted key, arms by id: what --set takes
  std::string value;     ///< in TOML's notation, which is JSON's, too
  std::string unit;      ///< empty: none
  std::string fallback;  ///< the default; "required" or "none"
  std::string allowed;
  std::string meaning;
};

/// Every value below a Config struct.
std::vector<EffectiveValue> ListValues(const ParameterTable& config);

/// The keys of a Config struct itself, not of the tables below it.
std::vector<std::string> KeysOf(const ParameterTable& config);

}  // namespace armada
