#pragma once

#include <cstdio>
#include <cstdlib>

namespace armada {

/// Ends the process when a property does not hold: libFuzzer keeps the input that led there.
inline void Require(bool holds, const char* property) {
  if (holds) return;
  std::fprintf(stderr, "violated: %s\n", property);
  std::abort();
}

}  // namespace armada
