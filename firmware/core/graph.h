#pragma once

#include <array>
#include <span>

#include "firmware/core/types.h"

namespace armada {

/// One directed link: arm `to` uses the state of arm `from` with weight eps_{to,from}.
struct Edge {
  int from = 0;
  int to = 0;
  double weight = 1.0;
};

/// One pinned arm: it sees the leader, with weight b_i.
struct Pin {
  int arm = 0;
  double weight = 1.0;
};

/// Weighted digraph of the arms (nodes 0 .. n-1) with pins to the leader: A = [eps_ij] and B of the paper.
class Digraph {
 public:
  static constexpr int kUnreachable = -1;

  explicit Digraph(int node_count) : node_count_(node_count) {}

  int node_count() const { return node_count_; }
  /// eps_ij: weight with which node i uses node j; 0 when it does not.
  void SetWeight(int i, int j, double eps_ij) { weight_[Index(i, j)] = eps_ij; }
  double weight(int i, int j) const { return weight_[Index(i, j)]; }
  /// b_i: weight with which node i uses the leader; 0 when it is not pinned.
  void SetPin(int i, double b_i) { pin_[static_cast<size_t>(i)] = b_i; }
  double pin(int i) const { return pin_[static_cast<size_t>(i)]; }
  bool HasPin() const;

  /// L = D - A, entry (i, j), of the paper's Section 2.2.
  double Laplacian(int i, int j) const;

  /// Hops from the leader to every node, 1 for pinned nodes, kUnreachable where no path exists.
  std::array<int, kMaxArms> DepthFromLeader() const;
  /// The same from node `root`: 0 for the root itself.
  std::array<int, kMaxArms> DepthFromNode(int root) const;

  /// Assumption (A1): the leader has a directed path to every node.
  bool LeaderReachesAll() const;
  /// Corollary 2: some node has a directed path to every other one.
  bool HasSpanningTree() const;

 private:
  size_t Index(int i, int j) const { return static_cast<size_t>(i) * kMaxArms + static_cast<size_t>(j); }
  void Spread(std::array<int, kMaxArms>& depth) const;

  int node_count_;
  std::array<double, static_cast<size_t>(kMaxArms) * kMaxArms> weight_{};
  std::array<double, kMaxArms> pin_{};
};

}  // namespace armada
