#pragma once

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <limits>

namespace armada {

/// Time of one call, us: the shortest of some batches, in which nothing else ran. Printed.
template <class Work>
double Cost_us(const char* name, Work work) {
  using Clock = std::chrono::steady_clock;
  constexpr int kBatches = 50;
  constexpr int kCalls = 1000;
  double shortest_us = std::numeric_limits<double>::infinity();
  for (int batch = 0; batch < kBatches; ++batch) {
    const auto begin = Clock::now();
    for (int i = 0; i < kCalls; ++i) work();
    const std::chrono::duration<double, std::micro> elapsed = Clock::now() - begin;
    shortest_us = std::min(shortest_us, elapsed.count() / kCalls);
  }
  std::printf("%-40s %6.3f us\n", name, shortest_us);
  return shortest_us;
}

}  // namespace armada
