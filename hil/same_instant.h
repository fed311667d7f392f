#pragma once

namespace armada {

/// Times nearer than this are the same: sums of periods have a grain of rounding.
inline constexpr double kSameInstant_s = 1e-9;

}  // namespace armada
