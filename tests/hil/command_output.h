#pragma once

#include <cstdio>
#include <string>
#include <vector>

namespace armada {

/// Runs a shell command and returns the lines it prints; empty when it fails.
inline std::vector<std::string> OutputLines(const std::string& command) {
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return {};
  std::vector<std::string> lines(1);
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) {
    if (c == '\n') {
      lines.emplace_back();
    } else {
      lines.back() += static_cast<char>(c);
    }
  }
  lines.pop_back();
  return pclose(pipe) == 0 ? lines : std::vector<std::string>();
}

}  // namespace armada
