#include "hil/scenario_rules.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "firmware/app/config/value_text.h"
#include "hil/fault_rules.h"
#include "hil/leader_path.h"

namespace armada {
namespace {

using Errors = std::vector<ConfigError>;

constexpr double kBetaMargin = 1.2;  // beta over the leader's bound

/// The ring that an arm's law lets its end effector into, about its base.
struct Ring {
  explicit Ring(const ArmEntry& entry) {
    const PlanarArm arm(entry.arm);
    base_m = arm.Base();
    inner_m = arm.reach_min_m() + entry.control.reference.reach_inner_margin_m;
    outer_m = arm.reach_max_m() - entry.control.reference.reach_outer_margin_m;
  }
  double RadiusOf(const TaskVector& x_m) const { return (x_m - base_m).norm(); }
  /// How far a radius lies outside; not above 0 inside.
  double Excess(double radius_m) const { return std::max(inner_m - radius_m, radius_m - outer_m); }
  std::string Text() const {
    return RoundedText(inner_m) + " to " + RoundedText(outer_m) + " m from its base";
  }

  TaskVector base_m;
  double inner_m = 0.0;
  double outer_m = 0.0;
};

void CheckSines(const LeaderConfig& leader, const ConfigCursor& at, Errors* errors) {
  if (leader.axes.size() == size_t{PlanarArm::kTaskDim}) return;
  Report(at.At("axis"),
         "given " + std::to_string(leader.axes.size()) + " [[leader.axis]], expected one an axis, " +
             std::to_string(PlanarArm::kTaskDim),
         errors);
}

void CheckWaypoints(const LeaderConfig& leader, const ConfigCursor& at, Errors* errors) {
  const ConfigCursor points = at.At("waypoints_m");
  if (leader.waypoints_m.empty())
    Report(points, "no waypoint is given, allowed are 1 or more of [x, y]", errors);
  for (size_t i = 0; i < leader.waypoints_m.size(); ++i) {
    const size_t count = leader.waypoints_m[i].size();
    if (count == size_t{PlanarArm::kTaskDim}) continue;
    Report(points.Element(i), "given " + std::to_string(count) + " numbers, expected 2, [x, y]", errors);
  }
}

// Leaderless fleets have no leader, and only they.
void CheckLeaderFits(const ScenarioConfig& scenario, const ConfigCursor& root, Errors* errors) {
  const bool leaderless = scenario.fleet.estimator.leaderless;
  const bool has_leader = scenario.leader.kind != LeaderKind::kNone;
  const std::string given = "given " + ValueText(scenario.leader.kind);
  if (leaderless && has_leader) {
    Report(root.At("leader.kind"), given + ", allowed with estimator.leaderless = true is \"none\"", errors);
  } else if (!leaderless && !has_leader) {
    Report(root.At("leader.kind"),
           given + ", allowed with estimator.leaderless = false are \"sine\", \"waypoints\"", errors);
  }
  const CriterionKind wanted = leaderless ? CriterionKind::kAgreement : CriterionKind::kTracking;
  if (scenario.criterion.kind != wanted) {
    Report(root.At("criterion.kind"),
           "given " + ValueText(scenario.criterion.kind) +
               ", allowed with estimator.leaderless = " + ValueText(leaderless) + " is " + ValueText(wanted),
           errors);
  }
  if (!has_leader && scenario.start.kind == StartKind::kNearLeader) {
    Report(root.At("start.kind"), "given \"near_leader\", allowed without a leader is \"box\"", errors);
  }
}

// Assumption A2, with room for what the sampled estimator needs.
void CheckBeta(const ScenarioConfig& scenario, const ConfigCursor& fleet_root, Errors* errors) {
  const LeaderBounds bounds = LeaderPath(scenario.leader).Bounds();
  const auto check = [&](const char* key, const char* unit, double beta, double bound) {
    if (beta >= kBetaMargin * bound) return;
    Report(fleet_root.At("estimator").At(key),
           "given " + ValueText(beta) + " " + unit + ", allowed by A2 is at least " + ValueText(kBetaMargin) +
               " times the leader's " + RoundedText(bound) + " " + unit + ", " +
               RoundedText(kBetaMargin * bound) + " " + unit,
           errors);
  };
  const EstimatorConfig& estimator = scenario.fleet.estimator;
  check("beta_1_m_s", "m/s", estimator.beta_1_m_s, bounds.v_m_s);
  check("beta_2_m_s2", "m/s^2", estimator.beta_2_m_s2, bounds.a_m_s2);
  check("beta_3_m_s3", "m/s^3", estimator.beta_3_m_s3, bounds.jerk_m_s3);
}

// The whole path lies within every arm's ring; of each arm that misses some, the worst point is told.
void CheckLeaderInReach(const ScenarioConfig& scenario, const ConfigCursor& root, Errors* errors) {
  const LeaderPath path(scenario.leader);
  const double period_s = std::isfinite(path.period_s()) ? path.period_s() : scenario.seconds;
  const int samples = static_cast<int>(std::clamp(period_s / 0.001, 1000.0, 100000.0));
  for (const ArmEntry& entry : scenario.fleet.arms) {
    const Ring ring(entry);
    double worst_m = 0.0;
    double worst_s = 0.0;
    for (int k = 0; k <= samples; ++k) {
      const double t_s = period_s * k / samples;
      const double excess_m = ring.Excess(ring.RadiusOf(path.At(t_s).x_m));
      if (excess_m > worst_m) {
        worst_m = excess_m;
        worst_s = t_s;
      }
    }
    if (worst_m <= 0.0) continue;
    Report(root.At("leader"),
           "out of reach of arm " + std::to_string(entry.id) + ": at t = " + RoundedText(worst_s) +
               " s the leader is " + RoundedText(ring.RadiusOf(path.At(worst_s).x_m)) +
               " m from its base; allowed is " + ring.Text(),
           errors);
  }
}

std::string AllIds(const FleetConfig& fleet) {
  std::string text;
  for (const ArmEntry& arm : fleet.arms) text += (text.empty() ? "" : ", ") + std::to_string(arm.id);
  return text;
}

bool Hears(const FleetConfig& fleet, int to, int from) {
  return std::any_of(fleet.topologies.begin(), fleet.topologies.end(), [&](const Topology& topology) {
    return std::any_of(topology.pins.begin(), topology.pins.end(),
                       [&](const Pin& pin) { return from == 0 && pin.arm == to; }) ||
           std::any_of(topology.edges.begin(), topology.edges.end(),
                       [&](const Edge& edge) { return edge.from == from && edge.to == to; });
  });
}

void CheckLostLinks(const ScenarioConfig& scenario, const ConfigCursor& at, Errors* errors) {
  for (size_t i = 0; i < scenario.network.lost.size(); ++i) {
    const LostLinkConfig& link = scenario.network.lost[i];
    if (!Hears(scenario.fleet, link.to, link.from)) {
      const std::string whom = link.from == 0 ? "the leader (from = 0)" : "arm " + std::to_string(link.from);
      Report(
          at.Element(i),
          "arm " + std::to_string(link.to) + " does not hear " + whom + " in any topology: nothing to lose",
          errors);
    }
    if (link.until_s <= link.at_s) {
      Report(
          at.Element(i).At("until_s"),
          "given " + ValueText(link.until_s) + " s, allowed is above at_s = " + ValueText(link.at_s) + " s",
          errors);
    }
  }
}

void CheckArms(const std::vector<int>& ids, const FleetConfig& fleet, const ConfigCursor& at,
               Errors* errors) {
  for (size_t i = 0; i < ids.size(); ++i) {
    if (fleet.IndexOf(ids[i]) >= 0) continue;
    Report(at.Element(i), "given " + std::to_string(ids[i]) + ", allowed are the arms " + AllIds(fleet),
           errors);
  }
}

void CheckStanding(const ScenarioConfig& scenario, const ConfigCursor& at, Errors* errors) {
  const std::vector<int>& standing = scenario.criterion.standing;
  CheckArms(standing, scenario.fleet, at, errors);
  if (!standing.empty() && scenario.leader.kind == LeaderKind::kNone)
    Report(at, "given arms that lose the leader, but there is none", errors);
}

void CheckOperations(const ScenarioConfig& scenario, const ConfigCursor& at, Errors* errors) {
  for (size_t i = 0; i < scenario.operations.size(); ++i) {
    const int id = scenario.operations[i].arm;
    if (id == 0 || scenario.fleet.IndexOf(id) >= 0) continue;
    Report(at.Element(i).At("arm"),
           "given " + std::to_string(id) + ", allowed are the arms " + AllIds(scenario.fleet) +
               ", and 0, all of them",
           errors);
  }
}

// Averaging never leaves the box of the starts: with all of it in reach, so is the point that is agreed on.
void CheckAgreementInReach(const ScenarioConfig& scenario, const ConfigCursor& root, Errors* errors) {
  const TaskVector& centre = scenario.start.zeta_x_centre_m;
  const double range = scenario.start.zeta_range;
  for (const ArmEntry& entry : scenario.fleet.arms) {
    const Ring ring(entry);
    const TaskVector from_base = (centre - ring.base_m).cwiseAbs();
    const double nearest_m = (from_base.array() - range).max(0.0).matrix().norm();
    const double farthest_m = (from_base.array() + range).matrix().norm();
    if (std::max(ring.Excess(nearest_m), ring.Excess(farthest_m)) <= 0.0) continue;
    Report(root.At("start.zeta_range"),
           "arm " + std::to_string(entry.id) +
               " may not reach the agreed point: it lies within zeta_range of "
               "zeta_x_centre_m on each axis, " +
               RoundedText(nearest_m) + " to " + RoundedText(farthest_m) +
               " m from the arm's base; allowed is " + ring.Text(),
           errors);
  }
}

}  // namespace

void CheckScenario(const ScenarioConfig& scenario, const ConfigCursor& root, Errors* errors) {
  const bool times_clean =
      IsClean(root.At("seconds"), *errors) && IsClean(root.At("window_start_s"), *errors);
  if (times_clean && scenario.window_start_s >= scenario.seconds) {
    Report(root.At("window_start_s"),
           "given " + ValueText(scenario.window_start_s) +
               " s, allowed is below seconds = " + ValueText(scenario.seconds) + " s",
           errors);
  }
  const ConfigCursor leader = root.At("leader");
  if (IsClean(leader, *errors)) {
    if (scenario.leader.kind == LeaderKind::kSine) CheckSines(scenario.leader, leader, errors);
    if (scenario.leader.kind == LeaderKind::kWaypoints) CheckWaypoints(scenario.leader, leader, errors);
  }
  const ConfigCursor centre = root.At("start.zeta_x_centre_m");
  const auto count = scenario.start.zeta_x_centre_m.size();
  if (IsClean(centre, *errors) && count != PlanarArm::kTaskDim) {
    Report(centre, "given " + std::to_string(count) + " values, allowed are 1 or one an axis, 2", errors);
  }
}

void CheckScenarioWithFleet(const ScenarioConfig& scenario, const ConfigCursor& root,
                            const ConfigCursor& fleet_root, Errors* errors) {
  const size_t errors_before = errors->size();
  CheckLeaderFits(scenario, root, errors);
  CheckLostLinks(scenario, root.At("network.lost"), errors);
  CheckStanding(scenario, root.At("criterion.standing"), errors);
  CheckArms(scenario.criterion.excused, scenario.fleet, root.At("criterion.excused"), errors);
  CheckFaults(scenario, root.At("fault"), errors);
  CheckOperations(scenario, root.At("operator"), errors);
  if (scenario.plant.step_s > scenario.fleet.timing.period_s) {
    Report(root.At("plant.step_s"),
           "given " + ValueText(scenario.plant.step_s) +
               " s, allowed is at most timing.period_s = " + ValueText(scenario.fleet.timing.period_s) + " s",
           errors);
  }
  if (scenario.drive.watchdog_s > 0.0 && scenario.drive.watchdog_s <= scenario.fleet.timing.period_s) {
    Report(root.At("drive.watchdog_s"),
           "given " + ValueText(scenario.drive.watchdog_s) +
               " s, allowed is 0 (off) or above timing.period_s = " +
               ValueText(scenario.fleet.timing.period_s) + " s",
           errors);
  }
  if (errors->size() > errors_before) return;
  if (scenario.leader.kind == LeaderKind::kNone) {
    CheckAgreementInReach(scenario, root, errors);
  } else {
    CheckBeta(scenario, fleet_root, errors);
    CheckLeaderInReach(scenario, root, errors);
  }
}

}  // namespace armada
