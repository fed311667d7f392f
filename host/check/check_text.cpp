#include <algorithm>
#include <cstdio>
#include <iomanip>
#include <ostream>

#include "host/check/check_output.h"
#include "host/check/findings.h"

namespace armada {
namespace {

std::string Significant(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g", value);
  return text;
}

// Cells of a table's row; the first is its head and left-aligned, the others are right-aligned.
using Row = std::vector<std::string>;

constexpr const char* kIndent = "    ";

void PrintTable(const std::vector<Row>& rows, std::ostream& out) {
  std::vector<size_t> widths;
  for (const Row& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  for (const Row& row : rows) {
    out << kIndent;
    for (size_t i = 0; i < row.size(); ++i) {
      out << (i == 0 ? std::left : std::right) << std::setw(static_cast<int>(widths[i] + (i == 0 ? 0 : 3)))
          << row[i];
    }
    out << '\n';
  }
}

void PrintHead(const std::string& head, bool holds, std::ostream& out) {
  out << '\n' << std::left << std::setw(72) << head << (holds ? "holds" : "FAILS") << '\n';
}

std::string Ids(const std::vector<int>& ids) {
  std::string text;
  for (const int id : ids) text += (text.empty() ? "" : " ") + std::to_string(id);
  return text;
}

std::string Depths(const CheckResult& result, const TopologyCheck& topology) {
  const int deepest = *std::max_element(topology.depth.begin(), topology.depth.end());
  std::string text;
  for (int depth = Digraph::kUnreachable; depth <= deepest; ++depth) {
    std::vector<int> ids;
    for (size_t i = 0; i < topology.depth.size(); ++i) {
      if (topology.depth[i] == depth) ids.push_back(result.arms[i].id);
    }
    if (ids.empty()) continue;
    const std::string head =
        depth == Digraph::kUnreachable ? "NOT REACHED" : "depth " + std::to_string(depth);
    text += (text.empty() ? "" : "; ") + head + ": " + Ids(ids);
  }
  return text;
}

std::string Cuts(const TopologyCheck& topology) {
  std::string text;
  for (const SingleCut& cut : topology.single_cuts) {
    const std::string from = cut.from_id == kLeaderId ? "leader" : std::to_string(cut.from_id);
    text +=
        (text.empty() ? "" : ", ") + from + "->" + std::to_string(cut.to_id) + " (" + Ids(cut.cut_ids) + ")";
  }
  return text.empty() ? "none" : text;
}

void PrintGraph(const CheckResult& result, std::ostream& out) {
  PrintHead(
      result.leaderless ? "Corollary 2: some arm reaches every other" : "A1: the leader reaches every arm",
      result.A1(), out);
  for (size_t k = 0; k < result.topologies.size(); ++k) {
    const TopologyCheck& topology = result.topologies[k];
    out << kIndent << (result.topologies.size() > 1 ? "topology " + std::to_string(k + 1) + ": " : "")
        << Depths(result, topology) << '\n'
        << kIndent << "links whose loss alone cuts arms off: " << Cuts(topology) << '\n';
  }
  if (result.leaderless) return;
  const auto oldest = std::max_element(
      result.arms.begin(), result.arms.end(),
      [](const ArmCheck& a, const ArmCheck& b) { return a.leader_news_s < b.leader_news_s; });
  out << kIndent << "news of the leader at most " << Fixed(oldest->leader_news_s, 2) << " s old (arm "
      << oldest->id << "); they count as lost above " << Fixed(result.age_max_s, 2) << " s\n";
}

void PrintEstimator(const EstimatorCheck& estimator, std::ostream& out) {
  PrintHead("A2: beta above the leader's bounds", estimator.holds(), out);
  constexpr const char* kNames[] = {"v [m/s]", "a [m/s^2]", "jerk [m/s^3]"};
  std::vector<Row> rows = {{"", "beta", "leader", "ratio"}};
  for (size_t k = 0; k < estimator.margins.size(); ++k) {
    const BetaMargin& margin = estimator.margins[k];
    rows.push_back({kNames[k], Fixed(margin.beta, 3), Fixed(margin.leader, 3), Fixed(margin.ratio(), 2)});
  }
  PrintTable(rows, out);
  out << kIndent << "estimates exact, in continuous time, after t_f <= " << Fixed(estimator.settled_max_s, 2)
      << " s from any start of the scenario\n";
}

Row ArmRow(const ArmCheck& arm) {
  Row row = {std::to_string(arm.id), std::to_string(arm.dof), Fixed(1e2 * arm.bus_load, 1)};
  auto add = [&](std::initializer_list<std::string> cells) { row.insert(row.end(), cells); };
  if (arm.estimate) add({Significant(1e3 * arm.estimate->x_m)});
  if (arm.disturbance) add({Fixed(arm.disturbance->K_r_min_Nm, 1), Fixed(arm.disturbance->d_2norm_Nm, 1)});
  if (arm.path) {
    const PathCheck& path = *arm.path;
    const TorqueNeed& torque = path.torques[path.WorstJoint()];
    add({Fixed(1e3 * path.reach_outer_m, 1), Fixed(1e3 * path.reach_inner_m, 1), Fixed(path.sigma_min, 3),
         Fixed(1e3 * path.error_m, 2), Fixed(torque.needed_Nm, 0), Fixed(torque.limit_Nm, 0),
         std::to_string(path.WorstJoint() + 1)});
  }
  return row;
}

void PrintArms(const CheckResult& result, std::ostream& out) {
  const bool disturbance = result.arms.front().disturbance.has_value();
  const bool path = result.arms.front().path.has_value();
  const bool estimate = result.arms.front().estimate.has_value();
  out << "\nArms\n";
  Row head = {"", "", "bus"};
  Row names = {"arm", "joints", "load %"};
  auto add = [&](const char* first, const char* second) {
    head.emplace_back(first);
    names.emplace_back(second);
  };
  if (estimate) add("estimate", "mm");
  if (disturbance) {
    add("K_r", "N m");
    add("|d|_2", "N m");
  }
  if (path) {
    add("to outer", "edge mm");
    add("to inner", "edge mm");
    add("sigma_min", "m/rad");
    add("ideal", "error mm");
    add("torque", "N m");
    add("limit", "N m");
    add("worst", "joint");
  }
  std::vector<Row> rows = {head, names};
  for (const ArmCheck& arm : result.arms) rows.push_back(ArmRow(arm));
  PrintTable(rows, out);
  if (path) {
    out << kIndent << "sigma_min, error and torque: estimated on "
        << Fixed(result.arms.front().path->sampled_s, 1)
        << " s of motion with perfect control, from an elbow bent\n"
        << kIndent << "to either side; torque of the nominal arm, with the disturbance's amplitude on top.\n";
  }
  if (estimate) {
    out << kIndent
        << "estimate: bound on its error on any axis in the window, for every leader as fast as this one.\n";
  }
  out << kIndent << "Bus load: every frame as long as stuff bits can make it.\n";
}

}  // namespace

void PrintText(const CheckResult& result, std::ostream& out) {
  out << result.name << "  " << result.file << "\n"
      << result.arms.size() << " arms, " << Fixed(1.0 / result.period_s, 0) << " Hz, "
      << result.topologies.size()
      << (result.topologies.size() == 1 ? " topology\n" : " topologies in turn\n");
  PrintGraph(result, out);
  if (result.estimator) PrintEstimator(*result.estimator, out);
  PrintArms(result, out);
  out << '\n';
  for (const Finding& finding : result.findings) {
    out << (finding.severity == Severity::kError ? "error: " : "warning: ") << finding.text << '\n';
  }
  out << (result.ok() ? "ok" : "not ok") << '\n';
}

}  // namespace armada
