#pragma once

#include <cstdint>

namespace armada {

/// Counts this process's heap allocations, to prove that the loop makes none. A program that links the object
/// library `armada_heap_counter` has malloc and its kin replaced by ones that count and forward to glibc.
class HeapCounter {
 public:
  /// False in builds with sanitizers, which need malloc for themselves: the count then stays 0.
  static bool available();

  /// Allocations and reallocations since the process started, in all threads, those in C libraries included.
  static uint64_t Allocations();
};

}  // namespace armada
