#include "host/check/graph_check.h"

#include <algorithm>

#include "firmware/app/leader_news.h"

namespace armada {
namespace {

struct Reached {
  int root = -1;  // index of an arm; -1: the leader
  std::vector<int> depth;
};

bool IsCutOff(int depth) {
  return depth == Digraph::kUnreachable;
}

Reached ReachedFrom(const Digraph& graph, int root) {
  const auto depth = root < 0 ? graph.DepthFromLeader() : graph.DepthFromNode(root);
  return {root, {depth.begin(), depth.begin() + graph.node_count()}};
}

Reached Reach(const Digraph& graph, bool leaderless) {
  if (!leaderless) return ReachedFrom(graph, -1);
  Reached best;
  auto fewest = static_cast<std::ptrdiff_t>(graph.node_count());
  for (int root = 0; root < graph.node_count(); ++root) {
    Reached reached = ReachedFrom(graph, root);
    const auto cut_off = std::count_if(reached.depth.begin(), reached.depth.end(), IsCutOff);
    if (cut_off >= fewest) continue;
    fewest = cut_off;
    best = std::move(reached);
  }
  return best;
}

// Arms that `without` no longer reaches and `with` does.
std::vector<int> CutOff(const FleetConfig& fleet, const Reached& with, const Reached& without) {
  std::vector<int> ids;
  for (size_t i = 0; i < fleet.arms.size(); ++i) {
    if (IsCutOff(without.depth[i]) && !IsCutOff(with.depth[i])) ids.push_back(fleet.arms[i].id);
  }
  return ids;
}

TopologyCheck CheckTopology(const FleetConfig& fleet, size_t index) {
  const bool leaderless = fleet.estimator.leaderless;
  const Digraph graph = fleet.Graph(index);
  const Reached reached = Reach(graph, leaderless);

  TopologyCheck check;
  if (reached.root >= 0) check.root_id = fleet.arms[static_cast<size_t>(reached.root)].id;
  check.depth = reached.depth;
  const auto try_without = [&](const Digraph& damaged, int from_id, int to_id) {
    std::vector<int> cut_ids = CutOff(fleet, reached, Reach(damaged, leaderless));
    if (!cut_ids.empty()) check.single_cuts.push_back({from_id, to_id, std::move(cut_ids)});
  };
  for (const Pin& pin : fleet.topologies[index].pins) {
    if (leaderless) break;
    Digraph damaged = graph;
    damaged.SetPin(fleet.IndexOf(pin.arm), 0.0);
    try_without(damaged, kLeaderId, pin.arm);
  }
  for (const Edge& edge : fleet.topologies[index].edges) {
    Digraph damaged = graph;
    damaged.SetWeight(fleet.IndexOf(edge.to), fleet.IndexOf(edge.from), 0.0);
    try_without(damaged, edge.from, edge.to);
  }
  return check;
}

// All links and pins of all topologies at once.
Digraph UnionGraph(const FleetConfig& fleet) {
  Digraph all(static_cast<int>(fleet.arms.size()));
  for (size_t k = 0; k < fleet.topologies.size(); ++k) {
    const Digraph graph = fleet.Graph(k);
    for (int i = 0; i < graph.node_count(); ++i) {
      if (graph.pin(i) > 0.0) all.SetPin(i, graph.pin(i));
      for (int j = 0; j < graph.node_count(); ++j) {
        if (graph.weight(i, j) > 0.0) all.SetWeight(i, j, graph.weight(i, j));
      }
    }
  }
  return all;
}

}  // namespace

bool TopologyCheck::holds() const {
  return std::none_of(depth.begin(), depth.end(), IsCutOff);
}

std::vector<int> CutOffInWindow(const ScenarioConfig& scenario) {
  const FleetConfig& fleet = scenario.fleet;
  Digraph graph = UnionGraph(fleet);
  const Reached whole = Reach(graph, false);
  for (const LostLinkConfig& link : scenario.network.lost) {
    if (link.at_s > scenario.window_start_s || link.until_s < scenario.seconds) continue;
    const int to = fleet.IndexOf(link.to);
    link.from == 0 ? graph.SetPin(to, 0.0) : graph.SetWeight(to, fleet.IndexOf(link.from), 0.0);
  }
  return CutOff(fleet, whole, Reach(graph, false));
}

std::vector<TopologyCheck> CheckTopologies(const FleetConfig& fleet) {
  std::vector<TopologyCheck> checks;
  for (size_t i = 0; i < fleet.topologies.size(); ++i) checks.push_back(CheckTopology(fleet, i));
  return checks;
}

}  // namespace armada
