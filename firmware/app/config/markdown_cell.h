#pragma once

#include <string>
#include <string_view>

namespace armada {

/// Text for a cell of a markdown table, which a bar would end.
inline std::string MarkdownCell(std::string_view text) {
  std::string escaped;
  for (const char c : text) escaped += c == '|' ? std::string("\\|") : std::string(1, c);
  return escaped;
}

}  // namespace armada
