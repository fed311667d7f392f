#include "firmware/app/config/fleet_rules.h"
#include "firmware/app/config/value_text.h"

namespace armada {
namespace {

/// The rules for one arm's limits and obstacles.
class BarrierRules {
 public:
  BarrierRules(const ArmLayout& arm, const ConfigCursor& root, const ConfigCursor& at,
               std::vector<ConfigError>* errors)
      : arm_(arm), avoidance_(arm.control.subtask.avoidance), root_(root), at_(at), errors_(errors) {}

  void CheckAll(double period_s) {
    for (const char* key : {"q_min_rad", "q_max_rad", "obstacle"}) {
      if (!IsClean(at_.At(key), *errors_)) return;
    }
    const bool limits_good =
        CheckCount("q_min_rad", arm_.arm.q_min_rad) && CheckCount("q_max_rad", arm_.arm.q_max_rad);
    if (limits_good) CheckRoom();
    CheckObstacles();
    if (avoidance_.enabled) CheckAvoidance(period_s);
  }

 private:
  int dof() const { return static_cast<int>(arm_.link.size()); }
  bool HasLimits() const { return arm_.arm.q_min_rad.size() > 0 || arm_.arm.q_max_rad.size() > 0; }
  /// A value of the subtask: this arm's own, else the fleet's.
  ConfigCursor Subtask(const std::string& key) const {
    const ConfigCursor of_fleet = root_.At("control.subtask." + key);
    const ConfigCursor own = at_.At("control.subtask." + key);
    return own.found() || !of_fleet.found() ? own : of_fleet;
  }
  static double Limit(const JointVector& limits, int j) { return limits[limits.size() == 1 ? 0 : j]; }
  void Report(const ConfigCursor& at, const std::string& text) { armada::Report(at, text, errors_); }

  bool CheckCount(const char* key, const JointVector& limits) {
    const auto count = limits.size();
    if (count <= 1 || count == dof()) return true;
    Report(at_.At(key), "given " + std::to_string(count) + " values, allowed are 1 or one a joint, " +
                            std::to_string(dof()));
    return false;
  }

  // Room between the limits, and the posture's goal in it.
  void CheckRoom() {
    const JointVector& min = arm_.arm.q_min_rad;
    const JointVector& max = arm_.arm.q_max_rad;
    const double margin = avoidance_.enabled ? avoidance_.joint_margin_rad : 0.0;
    for (int j = 0; j < dof() && min.size() > 0 && max.size() > 0; ++j) {
      if (Limit(min, j) + 2.0 * margin < Limit(max, j)) continue;
      Report(at_.At("q_min_rad"), "given " + ValueText(Limit(min, j)) + " rad for joint " +
                                      std::to_string(j + 1) +
                                      ", allowed is below its q_max_rad = " + ValueText(Limit(max, j)) +
                                      " by more than two margins of " + ValueText(margin));
      return;
    }
    const SubtaskConfig& subtask = arm_.control.subtask;
    if (subtask.kind != SubtaskKind::kPosture || subtask.joint > dof()) return;
    const int j = subtask.joint - 1;
    const bool above = min.size() == 0 || subtask.goal_rad >= Limit(min, j) + margin;
    const bool below = max.size() == 0 || subtask.goal_rad <= Limit(max, j) - margin;
    if (above && below) return;
    Report(Subtask("goal_rad"), "given " + ValueText(subtask.goal_rad) +
                                    " rad, allowed is an angle at least " + ValueText(margin) +
                                    " rad within the limits of joint " + std::to_string(subtask.joint));
  }

  void CheckObstacles() {
    const ConfigCursor obstacles = at_.At("obstacle");
    if (arm_.obstacle.size() > size_t{kMaxObstacles}) {
      Report(obstacles, "given " + std::to_string(arm_.obstacle.size()) + " obstacles, allowed are up to " +
                            std::to_string(kMaxObstacles));
      return;
    }
    const Eigen::Vector2d base(arm_.arm.base_x_m, arm_.arm.base_y_m);
    const double clearance_m = avoidance_.enabled ? avoidance_.clearance_m : 0.0;
    for (size_t k = 0; k < arm_.obstacle.size(); ++k) {
      // The base as a link of no length: all that can be said before the arm moves.
      const Eigen::Vector2d beside = base + Eigen::Vector2d(0.0, 1e-12);
      const double distance_m = SeparationOf(arm_.obstacle[k], base, beside).distance_m;
      if (distance_m >= clearance_m) continue;
      Report(obstacles.Element(k), "is " + RoundedText(distance_m) +
                                       " m from the arm's base; allowed is at least " + "the clearance, " +
                                       ValueText(clearance_m) + " m");
    }
  }

  void CheckAvoidance(double period_s) {
    if (!HasLimits() && arm_.obstacle.empty()) return;
    const char* limits = arm_.arm.q_min_rad.size() > 0 ? "q_min_rad" : "q_max_rad";
    const ConfigCursor at = at_.At(arm_.obstacle.empty() ? limits : "obstacle");
    const std::string off = "control.subtask.avoidance.enabled = false";
    if (dof() <= PlanarArm::kTaskDim) {
      Report(at,
             "given for arm " + std::to_string(arm_.id) + ", which has " + std::to_string(dof()) +
                 " joints and none to spare for keeping from it; allowed with more than 2 joints, or with " +
                 off);
    } else if (arm_.control.law == LawKind::kPaper) {
      Report(at,
             "given with law \"paper\", which as printed keeps from nothing; allowed with law \"robust\", "
             "or with " +
                 off);
    }
    if (avoidance_.rate_1_s * period_s > 1.0) {
      Report(Subtask("avoidance.rate_1_s"),
             "given " + ValueText(avoidance_.rate_1_s) +
                 " 1/s, allowed is at most 1 / timing.period_s = " + ValueText(1.0 / period_s) + " 1/s");
    }
  }

  const ArmLayout& arm_;
  const AvoidanceConfig& avoidance_;
  const ConfigCursor root_;
  const ConfigCursor at_;
  std::vector<ConfigError>* errors_;
};

}  // namespace

void CheckBarriers(const ArmLayout& arm, double period_s, const ConfigCursor& root, const ConfigCursor& at,
                   std::vector<ConfigError>* errors) {
  BarrierRules(arm, root, at, errors).CheckAll(period_s);
}

}  // namespace armada
