#include <algorithm>
#include <cmath>
#include <set>

#include "firmware/app/config/fleet_rules.h"
#include "firmware/app/config/value_text.h"
#include "firmware/app/leader_news.h"

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

// Ids of the arms that the leader does not reach.
std::string Unreached(const FleetConfig& fleet, const Digraph& graph) {
  const auto depth = graph.DepthFromLeader();
  std::string ids;
  for (size_t i = 0; i < fleet.arms.size(); ++i) {
    if (depth[i] == Digraph::kUnreachable)
      ids += (ids.empty() ? "" : ", ") + std::to_string(fleet.arms[i].id);
  }
  return ids;
}

// A1, for each topology or for all in turn: then the news of the leader must not get so old meanwhile that it
// counts as lost.
void CheckA1(const FleetConfig& fleet, const ConfigCursor& graphs, Errors* errors) {
  const std::vector<double> news_s = OldestLeaderNews(fleet);
  const auto oldest = std::max_element(news_s.begin(), news_s.end());
  const auto arm = fleet.arms[static_cast<size_t>(oldest - news_s.begin())].id;
  const double allowed_s = fleet.estimator.age_max_s;
  if (*oldest <= allowed_s + 1e-9) return;
  const std::string age = "the news of the leader at arm " + std::to_string(arm) + " get " +
                          RoundedText(*oldest) + " s old, and estimator.age_max_s = " + ValueText(allowed_s) +
                          " s";
  bool alone = false;
  for (size_t k = 0; k < fleet.topologies.size(); ++k) {
    const std::string unreached = Unreached(fleet, fleet.Graph(k));
    if (unreached.empty()) continue;
    alone = true;
    Report(graphs.Element(k),
           "the leader does not reach arm " + unreached +
               "; assumption A1 asks for a path of pins and edges to every arm" +
               (std::isfinite(*oldest) ? ", in each topology or in all together in good time: " + age : ""),
           errors);
  }
  if (!alone) Report(graphs.Element(0), age + "; allowed is not above it", errors);
}

// Agreement sees as many hops upstream as it counts: the leader's loss must be seen by the last arm.
void CheckSyncTicks(const FleetConfig& fleet, const Digraph& graph, const ConfigCursor& at, Errors* errors) {
  const auto depth = graph.DepthFromLeader();
  const int deepest = *std::max_element(depth.begin(), depth.begin() + graph.node_count());
  if (fleet.estimator.sync_ticks > deepest) return;
  Report(at,
         "an arm is " + std::to_string(deepest) + " hops from the leader, given estimator.sync_ticks = " +
             std::to_string(fleet.estimator.sync_ticks) + "; allowed is more than the hops",
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
  FleetConfig parsed;  // what a digraph needs
  parsed.timing = fleet.timing;
  parsed.estimator = fleet.estimator;
  parsed.topology_period_s = fleet.topology_period_s;
  for (const ArmLayout& arm : fleet.arm) parsed.arms.emplace_back().id = arm.id;
  bool good = IsClean(root.At("topology_period_s"), *errors) && IsClean(root.At("timing"), *errors) &&
              IsClean(root.At("estimator"), *errors);
  for (size_t k = 0; k < fleet.graph.size(); ++k) {
    const GraphLayout& graph = fleet.graph[k];
    good = CheckParts(fleet, graph, graphs.Element(k), errors) && good;
    parsed.topologies.push_back(
        {{graph.edges.begin(), graph.edges.end()}, {graph.pins.begin(), graph.pins.end()}});
  }
  if (!good) return;
  for (size_t k = 0; k < fleet.graph.size(); ++k) {
    const ConfigCursor at = graphs.Element(k);
    fleet.estimator.leaderless ? CheckLeaderless(parsed, k, at, errors)
                               : CheckSyncTicks(parsed, parsed.Graph(k), at, errors);
  }
  if (!fleet.estimator.leaderless) CheckA1(parsed, graphs, errors);
}

}  // namespace armada
