#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace armada {

/// The candidate that `word` was probably meant to be: at most a third of its characters differ.
std::optional<std::string> NearestName(std::string_view word, const std::vector<std::string>& candidates);

/// What to say of a key that is not one of `allowed`.
std::string UnknownKeyMessage(std::string_view key, const std::vector<std::string>& allowed);

}  // namespace armada
