#include "host/check/path_check.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "firmware/core/reference.h"

namespace armada {
namespace {

constexpr double kStep_s = 0.002;
constexpr double kSettle_s = 5.0;      // from the bent elbow to the path
constexpr double kMotionMax_s = 60.0;  // of the path, for what costs inverse kinematics
constexpr int kReachSamplesMax = 200'000;

void MeasureReach(const PlanarArm& arm, const LeaderPath& leader, double length_s, PathCheck& check) {
  check.reach_outer_m = check.reach_inner_m = std::numeric_limits<double>::infinity();
  const int samples = std::clamp(static_cast<int>(std::min(length_s / kStep_s, 1e9)), 1, kReachSamplesMax);
  for (int k = 0; k <= samples; ++k) {
    const double radius_m = (leader.At(length_s * k / samples).x_m - arm.Base()).norm();
    check.reach_outer_m = std::min(check.reach_outer_m, arm.reach_max_m() - radius_m);
    check.reach_inner_m = std::min(check.reach_inner_m, radius_m - arm.reach_min_m());
  }
}

// The arm as a perfect controller would move it.
// Pulls the perfect arm back onto the path against the integration's rounding.
constexpr Approach kApproach{.alpha_1_s = 50.0, .braking_m_s2 = 6.0, .speed_m_s = 2.0};

class PerfectMotion {
 public:
  PerfectMotion(const ArmEntry& entry, const LeaderPath& leader, double elbow_rad)
      : control_(entry.control), leader_(leader), arm_(entry.arm) {
    q_ = JointVector::Constant(arm_.dof(), elbow_rad);
    q_[0] = -entry.arm.base_orientation_rad;
    t_s_ = -kSettle_s;
    dq_ = Velocity(t_s_, q_);
    while (t_s_ < -0.5 * kStep_s) Advance();
    t_s_ = 0.0;
  }

  const PlanarArm& arm() const { return arm_; }
  double t_s() const { return t_s_; }
  const JointVector& q_rad() const { return q_; }
  const JointVector& dq_rad_s() const { return dq_; }

  // One step by the midpoint rule.
  void Advance() {
    const JointVector q_middle = q_ + 0.5 * kStep_s * dq_;
    q_ += kStep_s * Velocity(t_s_ + 0.5 * kStep_s, q_middle);
    t_s_ += kStep_s;
    dq_ = Velocity(t_s_, q_);
  }

 private:
  JointVector Velocity(double t_s, const JointVector& q) const {
    return ReferenceVelocity(control_.reference, kApproach, control_.pseudoinverse, control_.subtask, arm_, q,
                             leader_.At(t_s), true);
  }

  const ControlConfig& control_;
  const LeaderPath& leader_;
  PlanarArm arm_;
  double t_s_ = 0.0;
  JointVector q_;
  JointVector dq_;
};

void MeasureMotion(PerfectMotion motion, const LeaderPath& leader, double disturbance_Nm, PathCheck& check) {
  const PlanarArm& arm = motion.arm();
  const ParameterVector theta = arm.Theta();
  do {
    const Zeta leader_now = leader.At(motion.t_s());
    const JointVector dq = motion.dq_rad_s();
    const PlanarArm::Posture at = arm.At(motion.q_rad());
    motion.Advance();
    const JointVector ddq = (motion.dq_rad_s() - dq) / kStep_s;

    const JointVector tau_Nm = arm.Inertia(at, theta) * ddq + arm.Bias(at, dq, theta);
    for (size_t i = 0; i < check.torques.size(); ++i) {
      double& needed_Nm = check.torques[i].needed_Nm;
      needed_Nm = std::max(needed_Nm, std::abs(tau_Nm[static_cast<Eigen::Index>(i)]) + disturbance_Nm);
    }
    check.sigma_min = std::min(check.sigma_min, DampedPseudoinverse({}, arm.Jacobian(at)).sigma_min);
    check.clearance_m = std::min(check.clearance_m, ClearanceOf(arm, motion.q_rad()));
    check.limit_margin_rad = std::min(check.limit_margin_rad, LimitMarginOf(arm, motion.q_rad()));
    check.error_m = std::max(check.error_m, (leader_now.x_m - arm.Position(at)).norm());
  } while (motion.t_s() <= check.sampled_s);
}

}  // namespace

size_t PathCheck::WorstJoint() const {
  const auto worst =
      std::max_element(torques.begin(), torques.end(),
                       [](const TorqueNeed& a, const TorqueNeed& b) { return a.share() < b.share(); });
  return static_cast<size_t>(worst - torques.begin());
}

PathCheck CheckPath(const ScenarioConfig& scenario, const ArmEntry& entry, const LeaderPath& leader) {
  const double length_s = std::min(leader.period_s(), scenario.seconds);
  PathCheck check;
  MeasureReach(PlanarArm(entry.arm), leader, length_s, check);

  check.error_allowed_m = scenario.criterion.error_max_m;
  check.sampled_s = std::min(length_s, kMotionMax_s);
  check.sigma_min = check.clearance_m = check.limit_margin_rad = std::numeric_limits<double>::infinity();
  for (const JointDriveConfig& joint : entry.joints) check.torques.push_back({0.0, joint.torque_limit_Nm});
  const DisturbanceConfig& disturbance = scenario.disturbance;
  const double disturbance_Nm = disturbance.kind == DisturbanceKind::kNone ? 0.0 : disturbance.amplitude_Nm;
  constexpr double kElbow_rad = 1.2;
  for (const double elbow_rad : {kElbow_rad, -kElbow_rad}) {
    MeasureMotion(PerfectMotion(entry, leader, elbow_rad), leader, disturbance_Nm, check);
  }
  return check;
}

}  // namespace armada
