#include "firmware/core/graph.h"

#include <algorithm>

namespace armada {

bool Digraph::HasPin() const {
  return std::any_of(pin_.begin(), pin_.begin() + node_count_, [](double b) { return b > 0.0; });
}

double Digraph::Laplacian(int i, int j) const {
  if (i != j) return -weight(i, j);
  double degree = 0.0;
  for (int k = 0; k < node_count_; ++k) degree += weight(i, k);
  return degree;
}

// Breadth-first by rounds: a node without a depth takes 1 + the depth of any node it listens to.
void Digraph::Spread(std::array<int, kMaxArms>& depth) const {
  for (int round = 0; round < node_count_; ++round) {
    std::array<int, kMaxArms> next = depth;
    for (int i = 0; i < node_count_; ++i) {
      if (depth[static_cast<size_t>(i)] != kUnreachable) continue;
      for (int j = 0; j < node_count_; ++j) {
        const int of_j = depth[static_cast<size_t>(j)];
        int& of_i = next[static_cast<size_t>(i)];
        if (weight(i, j) > 0.0 && of_j != kUnreachable && (of_i == kUnreachable || of_j + 1 < of_i))
          of_i = of_j + 1;
      }
    }
    if (next == depth) return;
    depth = next;
  }
}

std::array<int, kMaxArms> Digraph::DepthFromLeader() const {
  std::array<int, kMaxArms> depth{};
  depth.fill(kUnreachable);
  for (int i = 0; i < node_count_; ++i) {
    if (pin(i) > 0.0) depth[static_cast<size_t>(i)] = 1;
  }
  Spread(depth);
  return depth;
}

std::array<int, kMaxArms> Digraph::DepthFromNode(int root) const {
  std::array<int, kMaxArms> depth{};
  depth.fill(kUnreachable);
  depth[static_cast<size_t>(root)] = 0;
  Spread(depth);
  return depth;
}

bool Digraph::LeaderReachesAll() const {
  const auto depth = DepthFromLeader();
  return std::none_of(depth.begin(), depth.begin() + node_count_, [](int d) { return d == kUnreachable; });
}

bool Digraph::HasSpanningTree() const {
  for (int root = 0; root < node_count_; ++root) {
    const auto depth = DepthFromNode(root);
    if (std::none_of(depth.begin(), depth.begin() + node_count_, [](int d) { return d == kUnreachable; }))
      return true;
  }
  return false;
}

}  // namespace armada
