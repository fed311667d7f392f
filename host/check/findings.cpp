#include "host/check/findings.h"

#include <algorithm>
#include <cstdio>

namespace armada {
namespace {

class Collector {
 public:
  void Error(const std::string& text) { findings_.push_back({Severity::kError, text}); }
  void Warning(const std::string& text) { findings_.push_back({Severity::kWarning, text}); }

  std::vector<Finding> Take() {
    std::stable_sort(findings_.begin(), findings_.end(),
                     [](const Finding& a, const Finding& b) { return a.severity > b.severity; });
    return std::move(findings_);
  }

 private:
  std::vector<Finding> findings_;
};

std::string ArmName(int id) {
  return "arm " + std::to_string(id);
}

void FindInGraph(const CheckResult& result, Collector& found) {
  for (size_t k = 0; k < result.topologies.size(); ++k) {
    const TopologyCheck& topology = result.topologies[k];
    if (topology.holds()) continue;
    std::string unreached;
    for (size_t i = 0; i < topology.depth.size(); ++i) {
      if (topology.depth[i] == Digraph::kUnreachable) unreached += " " + std::to_string(result.arms[i].id);
    }
    const std::string root = result.leaderless
                                 ? "no arm reaches all others; " + ArmName(topology.root_id) + " reaches most"
                                 : "the leader does not reach every arm";
    found.Error("A1 fails in topology " + std::to_string(k + 1) + ": " + root + "; not reached:" + unreached);
  }
}

void FindInEstimator(const EstimatorCheck& estimator, Collector& found) {
  constexpr const char* kQuantities[] = {"speed", "acceleration", "jerk"};
  for (size_t k = 0; k < estimator.margins.size(); ++k) {
    const BetaMargin& margin = estimator.margins[k];
    if (margin.holds()) continue;
    found.Error("A2 fails: beta_" + std::to_string(k + 1) + " = " + Fixed(margin.beta, 3) +
                " is not above the leader's largest " + kQuantities[k] + " of " + Fixed(margin.leader, 3));
  }
}

void FindInPath(const ArmEntry& entry, const PathCheck& path, Collector& found) {
  const std::string arm = ArmName(entry.id);
  const ReferenceConfig& reference = entry.control.reference;
  if (path.reach_outer_m < 0.0 || path.reach_inner_m < 0.0) {
    const bool outer = path.reach_outer_m < 0.0;
    found.Error(arm + ": the leader goes " +
                Fixed(-1e3 * (outer ? path.reach_outer_m : path.reach_inner_m), 1) + " mm " +
                (outer ? "beyond the outer" : "inside the inner") + " edge of its reach");
  } else if (path.reach_outer_m < reference.reach_outer_margin_m ||
             path.reach_inner_m < reference.reach_inner_margin_m) {
    found.Warning(arm +
                  ": the leader comes nearer to the edge of its reach than the margin that the reference "
                  "keeps; it lags by " +
                  Fixed(1e3 * path.error_m, 1) + " mm there");
  }
  const double sigma_threshold = entry.control.pseudoinverse.sigma_threshold_m;
  if (path.sigma_min < sigma_threshold) {
    found.Warning(arm + ": near a singularity on the leader's path, sigma_min(J) = " +
                  Fixed(path.sigma_min, 3) + " < " + Fixed(sigma_threshold, 3) +
                  " m/rad; J# is damped there, which leaves up to " + Fixed(1e3 * path.error_m, 1) + " mm");
  }
  const TorqueNeed& torque = path.torques[path.WorstJoint()];
  if (torque.share() > 1.0) {
    found.Warning(arm + ": joint " + std::to_string(path.WorstJoint() + 1) + " needs about " +
                  Fixed(torque.needed_Nm, 0) + " N m on the leader's path, above its limit of " +
                  Fixed(torque.limit_Nm, 0) + " N m");
  }
}

void FindInArm(const ArmEntry& entry, const ArmCheck& arm, Collector& found) {
  if (arm.path) FindInPath(entry, *arm.path, found);
  if (arm.disturbance && !arm.disturbance->holds()) {
    found.Warning(ArmName(arm.id) + ": K_r = " + Fixed(arm.disturbance->K_r_min_Nm, 1) +
                  " N m is below the disturbance's 2-norm of up to " + Fixed(arm.disturbance->d_2norm_Nm, 1) +
                  " N m; the theorem's condition is missed");
  }
  if (arm.bus_load > 1.0) {
    found.Error(ArmName(arm.id) + ": its bus would have to carry " + Fixed(1e2 * arm.bus_load, 0) +
                " % of what it can");
  }
}

}  // namespace

std::string Fixed(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", decimals, value);
  return text;
}

std::vector<Finding> Findings(const FleetConfig& fleet, const CheckResult& result) {
  Collector found;
  FindInGraph(result, found);
  if (result.estimator) FindInEstimator(*result.estimator, found);
  for (size_t i = 0; i < result.arms.size(); ++i) FindInArm(fleet.arms[i], result.arms[i], found);
  return found.Take();
}

}  // namespace armada
