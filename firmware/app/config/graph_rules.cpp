#include <algorithm>
#include <set>

#include "firmware/app/config/fleet_rules.h"
#include "firmware/app/config/value_text.h"

namespace armada {
namespace {

using Errors = std::vector<ConfigError>;

std::string AllIds(const FleetLayout& fleet) {
  std::string text;
  for (const ArmLayout& arm : fleet.arm) text += (text.empty() ? "" : ", ") + std::to_string(arm.id);
  return text;
}

bool CheckArmId(const FleetLayout& fleet, int id, const ConfigCursor& at, Errors* errors) {
  if (std::any_of(fleet.arm.begin(), fleet.arm.end(), [&](const ArmLayout& arm) { return arm.id == id; }))
    return true;
  Report(at, "given " + std::to_string(id) + ", allowed are the arms " + AllIds(fleet), errors);
  return false;
}

// The parts of one topology: known arms, no arm that listens to itself, nothing twice. True when all is well.
bool CheckParts(const FleetLayout& fleet, const GraphLayout& graph, const ConfigCursor& at, Errors* errors) {
  bool good = true;
  std::set<int> pinned;
  for (size_t i = 0; i < graph.pins.size(); ++i) {
    const ConfigCursor pin = at.At("pins").Element(i);
    good = CheckArmId(fleet, graph.pins[i].arm, pin.At("arm"), errors) && good;
    if (!pinned.insert(graph.pins[i].arm).second) {
      Report(pin.At("arm"), "given " + std::to_string(graph.pins[i].arm) + " twice", errors);
      good = false;
    }
  }
  std::set<std::pair<int, int>> linked;
  for (size_t i = 0; i < graph.edges.size(); ++i) {
    const EdgeLayout& edge = graph.edges[i];
    const ConfigCursor place = at.At("edges").Element(i);
    good = CheckArmId(fleet, edge.from, place.At("from"), errors) && good;
    good = CheckArmId(fleet, edge.to, place.At("to"), errors) && good;
    if (edge.from == edge.to) {
      Report(place, "given from arm " + std::to_string(edge.from) + " to itself; eps_ii is 0", errors);
      good = false;
    }
    if (!linked.insert({edge.from, edge.to}).second) {
      Report(place,
             "given from arm " + std::to_string(edge.from) + " to arm " + std::to_string(edge.to) + " twice",
             errors);
      good = false;
    }
  }
  return good;
}

void CheckA1(const FleetConfig& fleet, size_t topology, const ConfigCursor& at, Errors* errors) {
  const auto depth = fleet.Graph(topology).DepthFromLeader();
  std::string unreached;
  int deepest = 0;
  for (size_t i = 0; i < fleet.arms.size(); ++i) {
    deepest = std::max(deepest, depth[i]);
    if (depth[i] != Digraph::kUnreachable) continue;
    unreached += (unreached.empty() ? "" : ", ") + std::to_string(fleet.arms[i].id);
  }
  if (unreached.empty()) {
    // Agreement sees as many hops upstream as it counts: the leader's loss must be seen by the last arm.
    if (fleet.estimator.sync_ticks <= deepest) {
      Report(at,
             "an arm is " + std::to_string(deepest) + " hops from the leader, given estimator.sync_ticks = " +
                 std::to_string(fleet.estimator.sync_ticks) + "; allowed is more than the hops",
             errors);
    }
    return;
  }
  Report(at,
         "the leader does not reach arm " + unreached +
             "; assumption A1 asks for a path of pins and edges to every arm",
         errors);
}

void CheckLeaderless(const FleetConfig& fleet, size_t topology, const ConfigCursor& at, Errors* errors) {
  const Digraph graph = fleet.Graph(topology);
  if (graph.HasPin()) {
    Report(at.At("pins"),
           "given pins in a fleet with estimator.leaderless = true, which has no leader to pin to", errors);
  }
  if (!graph.HasSpanningTree()) {
    Report(at,
           "no arm has a path of edges to every other one, which Corollary 2 asks for (estimator.leaderless "
           "= true)",
           errors);
  }
}

void CheckSchedule(const FleetLayout& fleet, const ConfigCursor& root, Errors* errors) {
  const ConfigCursor at = root.At("topology_period_s");
  const bool several = fleet.graph.size() > 1;
  const std::string given = "given " + ValueText(fleet.topology_period_s) + " s";
  if (!several && fleet.topology_period_s > 0.0) {
    Report(at, given + ", but there is one [[graph]] only: leave it out, or give several", errors);
  }
  if (several && fleet.topology_period_s < fleet.timing.period_s) {
    Report(at,
           given + " for " + std::to_string(fleet.graph.size()) +
               " [[graph]], allowed is at least timing.period_s = " + ValueText(fleet.timing.period_s) + " s",
           errors);
  }
}

}  // namespace

void CheckGraphs(const FleetLayout& fleet, const ConfigCursor& root, Errors* errors) {
  const ConfigCursor graphs = root.At("graph");
  if (!IsClean(graphs, *errors)) return;
  if (fleet.graph.empty() || fleet.graph.size() > TopologySchedule::kMaxCount) {
    Report(graphs,
           "given " + std::to_string(fleet.graph.size()) + " topologies, allowed are 1 to " +
               std::to_string(TopologySchedule::kMaxCount) + " [[graph]]",
           errors);
    return;
  }
  if (IsClean(root.At("topology_period_s"), *errors) && IsClean(root.At("timing"), *errors)) {
    CheckSchedule(fleet, root, errors);
  }
  FleetConfig arms_and_graphs;  // ids are all that a digraph needs of the arms
  for (const ArmLayout& arm : fleet.arm) arms_and_graphs.arms.emplace_back().id = arm.id;
  for (size_t i = 0; i < fleet.graph.size(); ++i) {
    const GraphLayout& graph = fleet.graph[i];
    const ConfigCursor at = graphs.Element(i);
    if (!CheckParts(fleet, graph, at, errors)) continue;
    arms_and_graphs.topologies = {
        {{graph.edges.begin(), graph.edges.end()}, {graph.pins.begin(), graph.pins.end()}}};
    if (!IsClean(root.At("estimator.leaderless"), *errors)) continue;
    fleet.estimator.leaderless ? CheckLeaderless(arms_and_graphs, 0, at, errors)
                               : CheckA1(arms_and_graphs, 0, at, errors);
  }
}

}  // namespace armada
