#pragma once

#include <string>

#include "firmware/core/parameter.h"

namespace armada {

// What is said of a parameter's values.

/// "0.0001 to 1": the legal range of a number.
std::string NumbersText(const ParameterInfo& info);
/// "0.0001 to 1 s": the same with its unit.
std::string RangeText(const ParameterInfo& info);
/// "paper", "robust": all names, quoted.
std::string AllNames(const Choice& choice);

/// The value in TOML's notation.
std::string ValueText(const ParameterValue& value);
/// The legal values.
std::string AllowedText(const ParameterInfo& info, const ParameterValue& value);
/// The value as a default. "required" and "none" are no values: a key that must be given, and one that may be
/// left out.
std::string DefaultText(const ParameterInfo& info, const ParameterValue& value);

/// A default that is not itself a legal value says that the key must be given.
bool IsRequired(const ParameterInfo& info, const ParameterValue& value);
/// No text stands for a list without values: it was not given.
bool IsAbsent(const ParameterValue& value);

}  // namespace armada
