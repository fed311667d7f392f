#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace armada {

/// A message that has come, as its receiver sees it. `channel` and `payload` are valid during the handler's
/// call only.
struct LcmMessage {
  std::string_view channel;
  std::span<const uint8_t> payload;
  int64_t arrival_ns = 0;  ///< CLOCK_MONOTONIC at which it reached this host, not at which it was read
};

}  // namespace armada
