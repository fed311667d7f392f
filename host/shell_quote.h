#pragma once

#include <string>

namespace armada {

/// `word` as a POSIX shell has to be told it: as it is where nothing in it means anything to a shell.
std::string ShellQuoted(const std::string& word);

}  // namespace armada
