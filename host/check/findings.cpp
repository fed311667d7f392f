#include "host/check/findings.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace armada {
namespace {

// Sentences about one arm.
class Collector {
 public:
  explicit Collector(int id) : arm_("arm " + std::to_string(id) + ": ") {}

  void Error(const std::string& text) { findings_.push_back({Severity::kError, arm_ + text}); }
  void Warning(const std::string& text) { findings_.push_back({Severity::kWarning, arm_ + text}); }
  const std::vector<Finding>& findings() const { return findings_; }

 private:
  std::string arm_;
  std::vector<Finding> findings_;
};

void JudgePath(const PathCheck& path, double sigma_threshold_m, Collector& found) {
  if (path.error_m > path.error_allowed_m) {
    found.Error("would miss the leader by " + Fixed(1e3 * path.error_m, 1) +
                " mm under perfect control; criterion.error_max_m is " +
                Fixed(1e3 * path.error_allowed_m, 1) + " mm");
  }
  if (path.sigma_min < sigma_threshold_m) {
    found.Warning("comes near a singularity on the leader's path: sigma_min(J) = " +
                  Fixed(path.sigma_min, 3) + " m/rad; below " + Fixed(sigma_threshold_m, 3) +
                  " J# is damped, which leaves up to " + Fixed(1e3 * path.error_m, 1) + " mm");
  }
  const TorqueNeed& torque = path.torques[path.WorstJoint()];
  if (torque.share() > 1.0) {
    found.Warning("joint " + std::to_string(path.WorstJoint() + 1) + " needs about " +
                  Fixed(torque.needed_Nm, 0) + " N m on the leader's path, above its limit of " +
                  Fixed(torque.limit_Nm, 0) + " N m");
  }
}

std::string Percent(double share) {
  return Fixed(1e2 * share, 1) + " %";
}

void JudgePosture(const PostureCheck& posture, Collector& found) {
  const std::string joint = "joint " + std::to_string(posture.joint);
  const double way = std::max(posture.stretched, posture.folded);
  if (!posture.attainable()) {
    found.Warning(joint + " can be at its posture of " + Fixed(posture.goal_rad, 3) + " rad on " +
                  Percent(posture.at_goal) + " of the leader's path only");
  } else if (!posture.from_every_start() && way > 0.0) {
    found.Warning(joint + " comes to its posture from the other side only while it can stretch or fold, on " +
                  Percent(way) + " of the leader's path");
  } else if (!posture.from_every_start()) {
    found.Warning(joint +
                  " cannot come to its posture from the other side: on the leader's path it can "
                  "neither stretch nor fold");
  }
}

// Perfect control leaves nothing of a margin but what the leader's path, or another barrier, takes away.
void JudgeBarriers(const PathCheck& path, const AvoidanceConfig& avoidance, Collector& found) {
  constexpr double kShare = 0.9;
  if (!avoidance.enabled) return;
  if (path.clearance_m < kShare * avoidance.clearance_m) {
    found.Warning("comes to " + Fixed(1e3 * path.clearance_m, 0) +
                  " mm from an obstacle on the leader's path (below 0: into it); clearance_m is " +
                  Fixed(1e3 * avoidance.clearance_m, 0) + " mm");
  }
  if (path.limit_margin_rad < kShare * avoidance.joint_margin_rad) {
    found.Warning(
        "comes to " + Fixed(path.limit_margin_rad, 3) +
        " rad from a joint's limit on the leader's path (below 0: beyond it); joint_margin_rad is " +
        Fixed(avoidance.joint_margin_rad, 3));
  }
}

}  // namespace

std::vector<Finding> FindingsOf(const ArmEntry& entry, const ArmCheck& arm) {
  Collector found(arm.id);
  if (const std::string error = BusLoadError(arm.bus_load); !error.empty()) found.Error(error);
  if (arm.path) {
    JudgePath(*arm.path, entry.control.pseudoinverse.sigma_threshold_m, found);
    JudgeBarriers(*arm.path, entry.control.subtask.avoidance, found);
  }
  if (arm.posture) JudgePosture(*arm.posture, found);
  if (arm.disturbance && !arm.disturbance->holds()) {
    found.Warning("K_r = " + Fixed(arm.disturbance->K_r_min_Nm, 1) +
                  " N m is below the disturbance's 2-norm of up to " + Fixed(arm.disturbance->d_2norm_Nm, 1) +
                  " N m: the theorem's condition is missed");
  }
  return found.findings();
}

std::vector<Finding> FindingsOfLostLinks(const ScenarioConfig& scenario) {
  const std::vector<int> cut_off = CutOffInWindow(scenario);
  std::vector<Finding> findings;
  for (const ArmEntry& entry : scenario.fleet.arms) {
    const bool is_cut_off = std::find(cut_off.begin(), cut_off.end(), entry.id) != cut_off.end();
    const bool stands = scenario.criterion.Stands(entry.id);
    const std::string arm = "arm " + std::to_string(entry.id);
    if (is_cut_off && stands) {
      findings.push_back(
          {Severity::kWarning, arm + " loses the leader by network.lost; it must brake and stand still"});
    } else if (is_cut_off) {
      findings.push_back(
          {Severity::kError, arm + " loses the leader by network.lost, and criterion.standing does not "
                                   "name it: it is to track a leader it does not know of"});
    } else if (stands) {
      findings.push_back(
          {Severity::kError, arm + " is to stand still by criterion.standing, but does not lose the leader"});
    }
  }
  return findings;
}

std::vector<Finding> FindingsOfSensors(const ScenarioConfig& scenario) {
  constexpr double kWorse = 2.0;  // what a filter's gains forgive
  const EmulatedDriveConfig& drive = scenario.drive;
  std::vector<Finding> findings;
  for (const ArmEntry& entry : scenario.fleet.arms) {
    Collector found(entry.id);
    const SensorConfig& believed = entry.control.sensor;
    for (size_t i = 0; i < entry.joints.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      const double counts = drive.encoder_counts_per_turn * entry.joints[i].gear_ratio;
      const double position_rad = counts > 0.0 ? 2.0 * std::numbers::pi / counts / std::sqrt(12.0) : 0.0;
      const std::string joint = "joint " + std::to_string(i + 1) + "'s ";
      if (position_rad > kWorse * believed.position_deviation_rad[row]) {
        found.Warning(joint + "encoder is worse than control.sensor.position_deviation_rad says");
      }
      if (drive.velocity_noise_rad_s > kWorse * believed.velocity_deviation_rad_s[row]) {
        found.Warning(joint + "velocity is worse than control.sensor.velocity_deviation_rad_s says");
      }
    }
    findings.insert(findings.end(), found.findings().begin(), found.findings().end());
  }
  return findings;
}

std::string BusLoadError(double load) {
  if (!std::isfinite(load)) return "emulated drives of this configuration do not come up";
  return load > 1.0 ? "its bus would have to carry " + Fixed(1e2 * load, 0) + " % of what it can" : "";
}

std::string Fixed(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", decimals, value);
  return text;
}

}  // namespace armada
