#include "firmware/app/config/config_error.h"

#include <algorithm>
#include <ostream>

namespace armada {

std::string ToString(const ConfigError& error) {
  std::string text = error.file;
  if (error.line > 0) text.append(":").append(std::to_string(error.line));
  text += ": ";
  if (!error.key.empty()) text += error.key + ": ";
  return text + error.message;
}

void PrintErrors(const std::vector<ConfigError>& errors, std::ostream& out) {
  for (const ConfigError& error : errors) out << ToString(error) << '\n';
}

void SortByPlace(std::vector<ConfigError>* errors, size_t first) {
  std::vector<std::string> files;
  for (size_t i = first; i < errors->size(); ++i) {
    if (std::find(files.begin(), files.end(), (*errors)[i].file) == files.end())
      files.push_back((*errors)[i].file);
  }
  const auto rank = [&](const ConfigError& error) {
    return std::pair(std::find(files.begin(), files.end(), error.file) - files.begin(), error.line);
  };
  std::stable_sort(errors->begin() + static_cast<std::ptrdiff_t>(first), errors->end(),
                   [&](const ConfigError& a, const ConfigError& b) { return rank(a) < rank(b); });
}

}  // namespace armada
