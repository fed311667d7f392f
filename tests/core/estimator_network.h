#pragma once

#include <vector>

#include "firmware/core/estimator.h"
#include "firmware/core/graph.h"

namespace armada {

/// Estimators (1.9) of a fleet in lock step: at every tick each hears the state that the others have at that
/// tick.
class EstimatorNetwork {
 public:
  EstimatorNetwork(const EstimatorConfig& config, const Digraph& graph, const std::vector<Zeta>& initial)
      : graph_(graph) {
    for (const Zeta& zeta : initial) nodes_.emplace_back(config, zeta);
  }

  /// Corollary 3: another topology from the next tick on.
  void Switch(const Digraph& graph) { graph_ = graph; }

  /// One tick of `h_s` with the leader's state at its start, and its jerk if it tells it.
  void Tick(const Zeta& leader, double h_s, const TaskVector& jerk_m_s3 = TaskVector::Zero(kMaxTaskDim)) {
    const std::vector<Estimator> before = nodes_;
    for (int i = 0; i < graph_.node_count(); ++i) {
      Neighbours heard;
      const auto add = [&](const Neighbour& neighbour) {
        if (neighbour.weight > 0.0) heard.list[static_cast<size_t>(heard.count++)] = neighbour;
      };
      add({graph_.pin(i), leader, 0.0, Estimator::kMaxAgreement, true, 0.0, jerk_m_s3});
      for (int j = 0; j < graph_.node_count(); ++j) {
        const Estimator& other = before[static_cast<size_t>(j)];
        add({graph_.weight(i, j), other.zeta(), 0.0, other.agreement(), true, other.leader_age_s(),
             other.jerk_m_s3()});
      }
      nodes_[static_cast<size_t>(i)].Update(heard, h_s);
    }
  }

  const std::vector<Estimator>& nodes() const { return nodes_; }

 private:
  Digraph graph_;
  std::vector<Estimator> nodes_;
};

}  // namespace armada
