#pragma once

#include <vector>

#include "hil/scenario.h"

namespace armada {

inline constexpr int kLeaderId = 0;

/// A link whose loss alone cuts arms off.
struct SingleCut {
  int from_id = kLeaderId;  ///< kLeaderId: a pin
  int to_id = 0;
  std::vector<int> cut_ids;
};

/// Assumption (A1) for one topology: the leader has a directed path to every arm. Corollary 2, without a
/// leader: some arm has one to every other arm; the one that reaches most arms then stands for the leader.
struct TopologyCheck {
  int root_id = kLeaderId;
  std::vector<int> depth;  ///< hops from the root, by index of the arm; Digraph::kUnreachable
  std::vector<SingleCut> single_cuts;

  bool holds() const;
};

/// Ids of the arms that the leader does not reach through all topologies together without the links that
/// network.lost keeps down over the whole window. @pre a leader.
std::vector<int> CutOffInWindow(const ScenarioConfig& scenario);

/// One result a topology, in order.
std::vector<TopologyCheck> CheckTopologies(const FleetConfig& fleet);

}  // namespace armada
