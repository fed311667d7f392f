#pragma once

#include <cmath>

namespace armada {

/// The float nearest to `value` that is not larger in magnitude: a torque at its limit does not pass it by
/// rounding.
inline float FloatTowardZero(double value) {
  const auto nearest = static_cast<float>(value);
  return std::abs(static_cast<double>(nearest)) > std::abs(value) ? std::nextafter(nearest, 0.0f) : nearest;
}

}  // namespace armada
