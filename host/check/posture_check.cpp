#include "host/check/posture_check.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace armada {
namespace {

constexpr int kSamples = 2000;  // of the path

/// Lengths that a chain of links can span.
struct Span {
  double sum_m = 0.0;
  double longest_m = 0.0;

  void Add(double length_m) {
    sum_m += length_m;
    longest_m = std::max(longest_m, length_m);
  }
  bool Contains(double length_m) const {
    constexpr double kRounding_m = 1e-9;
    return length_m <= sum_m + kRounding_m && length_m >= 2.0 * longest_m - sum_m - kRounding_m;
  }
};

/// Length of the side that two links enclose at an angle; 0: in line.
double Enclosed(double a_m, double b_m, double angle_rad) {
  return std::sqrt(std::max(0.0, a_m * a_m + b_m * b_m + 2.0 * a_m * b_m * std::cos(angle_rad)));
}

/// True when the tip can be `radius_m` from the base with the corner at joint j, from 0, at an angle from in
/// line. At the first joint the corner is that of its link and the line from tip to base.
bool Closes(const PlanarArmConfig& arm, int j, double radius_m, double angle_rad) {
  const auto length = [&](int i) { return arm.links[static_cast<size_t>(i)].l_m; };
  Span others;
  for (int i = 0; i < arm.dof; ++i) {
    if (i != j && i != j - 1) others.Add(length(i));
  }
  const double before_m = j == 0 ? radius_m : length(j - 1);
  const double side_m = Enclosed(before_m, length(j), angle_rad);
  if (j == 0) return others.Contains(side_m);
  others.Add(side_m);
  return others.Contains(radius_m);
}

}  // namespace

PostureCheck CheckPosture(const ScenarioConfig& scenario, const ArmEntry& entry, const LeaderPath& leader) {
  const PlanarArmConfig& arm = entry.arm;
  const SubtaskConfig& subtask = entry.control.subtask;
  const int j = subtask.joint - 1;
  PostureCheck check;
  check.joint = subtask.joint;
  check.goal_rad = subtask.goal_rad;
  check.any_turn = HasGoalInEveryTurn(subtask, arm);
  const double length_s = std::min(leader.period_s(), scenario.seconds);
  for (int k = 0; k < kSamples; ++k) {
    const TaskVector line = leader.At(length_s * k / kSamples).x_m - PlanarArm(arm).Base();
    // From tip to base: the other way round.
    const double before = std::atan2(-line[1], -line[0]) - arm.base_orientation_rad;
    const double goal = subtask.goal_rad - (j == 0 ? before : 0.0);
    check.at_goal += Closes(arm, j, line.norm(), goal);
    check.stretched += Closes(arm, j, line.norm(), 0.0);
    check.folded += Closes(arm, j, line.norm(), std::numbers::pi);
  }
  for (double* share : {&check.at_goal, &check.stretched, &check.folded}) *share /= kSamples;
  return check;
}

}  // namespace armada
