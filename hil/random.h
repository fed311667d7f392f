#pragma once

#include <cstdint>

namespace armada {

/// Mixes a 64-bit value (the finaliser of SplitMix64): the base of every random number in the emulation, so
/// that the same seed gives the same run on every machine and in any order of evaluation.
constexpr uint64_t Mix(uint64_t value) {
  value += 0x9E3779B97F4A7C15ull;
  value = (value ^ (value >> 30)) * 0xBF58476D1CE4E5B9ull;
  value = (value ^ (value >> 27)) * 0x94D049BB133111EBull;
  return value ^ (value >> 31);
}

/// A number for a place in a run: which seed, which purpose, which element.
constexpr uint64_t RandomBits(uint64_t seed, uint64_t purpose, uint64_t a, uint64_t b = 0) {
  return Mix(Mix(Mix(Mix(seed) ^ purpose) ^ a) ^ b);
}

/// Uniform in [low, high) from 53 of the bits.
constexpr double Uniform(uint64_t bits, double low, double high) {
  return low + (high - low) * (static_cast<double>(bits >> 11) * 0x1.0p-53);
}

/// Purposes: separate streams of one seed.
enum RandomPurpose : uint64_t {
  kStartStream = 1,
  kDisturbanceStream,
  kNetworkStream,
  kSensorStream,
  kFleetStream,
  kFaultStream,
  kTrialStream
};

}  // namespace armada
