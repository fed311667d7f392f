#pragma once

#include <cstdint>
#include <limits>

namespace armada {

inline constexpr int64_t kMs = 1'000'000;  ///< in nanoseconds
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

}  // namespace armada
