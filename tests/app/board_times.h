#pragma once

#include <cstdint>

namespace armada {

/// Of the boards that these tests run, on the monotonic clock.
inline constexpr int64_t kEpochNs = 1'000'000'000;
inline constexpr int64_t kPeriodNs = 10'000'000;

}  // namespace armada
