#include "firmware/app/config/spelling.h"

#include <algorithm>
#include <numeric>

namespace armada {
namespace {

// Levenshtein's distance: insertions, deletions and replacements of one character.
size_t Distance(std::string_view a, std::string_view b) {
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 0; i < a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i + 1;
    for (size_t j = 0; j < b.size(); ++j) {
      const size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::optional<std::string> NearestName(std::string_view word, const std::vector<std::string>& candidates) {
  constexpr size_t kLongestName = 64;
  if (word.size() > kLongestName) return std::nullopt;
  std::optional<std::string> nearest;
  size_t smallest = std::max<size_t>(1, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const size_t distance = Distance(word, candidate);
    if (distance < smallest) {
      smallest = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

std::string UnknownKeyMessage(std::string_view key, const std::vector<std::string>& allowed) {
  if (const auto nearest = NearestName(key, allowed))
    return "unknown key; did you mean \"" + *nearest + "\"?";
  std::string text = "unknown key; allowed are ";
  for (size_t i = 0; i < allowed.size(); ++i) text += (i == 0 ? "" : ", ") + allowed[i];
  return text;
}

}  // namespace armada
