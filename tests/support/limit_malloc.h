#pragma once

#include <gtest/gtest.h>

#include "firmware/app/heap_counter.h"

namespace armada {

/// Fails the running test if anything allocates between this object's construction and its destruction. In
/// builds with sanitizers nothing can be counted and it checks nothing. Link `armada_heap_counter`.
class LimitMalloc {
 public:
  LimitMalloc() : before_(HeapCounter::Allocations()) {}
  LimitMalloc(const LimitMalloc&) = delete;
  LimitMalloc& operator=(const LimitMalloc&) = delete;
  ~LimitMalloc() {
    const uint64_t allocations = HeapCounter::Allocations() - before_;
    EXPECT_EQ(allocations, 0u) << "heap allocations in a scope that must make none";
  }

 private:
  const uint64_t before_;
};

}  // namespace armada
