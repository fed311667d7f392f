#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "hil/random.h"

namespace armada {

/// Random draws, one after the other; the same seed gives the same ones.
class Dice {
 public:
  explicit Dice(uint64_t seed) : seed_(seed) {}

  double In(double low, double high) { return Uniform(Next(), low, high); }
  /// As likely in every decade. @pre 0 < low <= high
  double InDecades(double low, double high) { return std::exp(In(std::log(low), std::log(high))); }
  size_t Below(size_t count) { return static_cast<size_t>(In(0.0, static_cast<double>(count))); }
  bool Comes(double probability) { return In(0.0, 1.0) < probability; }
  template <class T, size_t kCount>
  T OneOf(const std::array<T, kCount>& all) {
    return all[Below(kCount)];
  }

 private:
  uint64_t Next() { return RandomBits(seed_, kTrialStream, draws_++); }

  uint64_t seed_;
  uint64_t draws_ = 0;
};

}  // namespace armada
