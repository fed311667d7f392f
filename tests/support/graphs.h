#pragma once

#include "firmware/core/graph.h"
#include "hil/random.h"

namespace armada {

/// A line: the leader is heard by node 0, and node i by node i + 1.
inline Digraph LineGraph(int count) {
  Digraph graph(count);
  graph.SetPin(0, 1.0);
  for (int i = 1; i < count; ++i) graph.SetWeight(i, i - 1, 1.0);
  return graph;
}

/// The line with its ends joined and every link in both directions.
inline Digraph TwoWayRingGraph(int count) {
  Digraph graph = LineGraph(count);
  for (int i = 0; i < count; ++i) {
    graph.SetWeight(i, (i + 1) % count, 1.0);
    graph.SetWeight((i + 1) % count, i, 1.0);
  }
  return graph;
}

/// Each node after the first two, which are pinned, hears one or two earlier ones; besides there are as many
/// random links again, cycles among them, and no two weights are equal.
inline Digraph RandomGraph(int count, uint64_t seed) {
  Digraph graph(count);
  uint64_t draws = 0;
  const auto below = [&](int end) {
    return static_cast<int>(Uniform(RandomBits(seed, 77, draws++), 0.0, static_cast<double>(end)));
  };
  const auto weight = [&] { return Uniform(RandomBits(seed, 78, draws++), 0.5, 2.0); };
  for (int i = 0; i < count; ++i) {
    if (i < 2) {
      graph.SetPin(i, weight());
      continue;
    }
    for (int k = 0; k < 2; ++k) graph.SetWeight(i, below(i), weight());
    const int other = below(count);
    if (other != i) graph.SetWeight(i, other, weight());
  }
  return graph;
}

}  // namespace armada
