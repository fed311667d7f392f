#include "host/metrics.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "firmware/app/whole_file.h"
#include "firmware/core/named_enum.h"
#include "host/floor/floor.h"

namespace armada {
namespace {

template <class T>
nlohmann::ordered_json OrNull(const std::optional<T>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

void AddFloor(const std::optional<double>& floor_rms_m, double rms_m, nlohmann::ordered_json* json) {
  if (!floor_rms_m) return;
  (*json)["floor_rms_mm"] = *floor_rms_m * 1e3;
  (*json)["over_floor"] = rms_m / *floor_rms_m;
}

nlohmann::ordered_json OrNull(const JointVector& limits) {
  if (limits.size() == 0) return nullptr;
  return std::vector<double>(limits.begin(), limits.end());
}

/// What is only there for an arm with a posture, with obstacles, with limits.
void AddSpareJoints(const ArmMetrics& arm, nlohmann::ordered_json* json) {
  if (arm.posture) {
    (*json)["posture_joint"] = arm.posture->joint;
    (*json)["posture_goal_rad"] = arm.posture->goal_rad;
    (*json)["posture_max_rad"] = arm.posture->max_rad;
  }
  if (arm.clearance) {
    (*json)["clearance_min_m"] = arm.clearance->min_m;
    (*json)["clearance_wanted_m"] = arm.clearance->wanted_m;
  }
  if (arm.limits) {
    (*json)["limit_margin_min_rad"] = arm.limits->margin_min_rad;
    (*json)["q_min_rad"] = OrNull(arm.limits->q_min_rad);
    (*json)["q_max_rad"] = OrNull(arm.limits->q_max_rad);
  }
}

nlohmann::ordered_json ToJson(const ArmMetrics& arm) {
  nlohmann::ordered_json json = {
      {"id", arm.id},
      {"dof", arm.dof},
      {"subtask", NameOf(arm.subtask)},
      {"diverged", arm.diverged},
      {"settled_s", OrNull(arm.settled_s)},
      {"rms_mm", arm.rms_m * 1e3},
      {"max_mm", arm.max_m * 1e3},
      {"estimator_rms",
       {{"x", arm.estimator_rms.x_m}, {"v", arm.estimator_rms.v_m_s}, {"a", arm.estimator_rms.a_m_s2}}},
      {"estimator_max",
       {{"x", arm.estimator_max.x_m}, {"v", arm.estimator_max.v_m_s}, {"a", arm.estimator_max.a_m_s2}}},
      {"joint_speed_max", arm.joint_speed_max_rad_s},
      {"standing", arm.standing},
      {"torque_max_nm", arm.torque_max_Nm},
      {"saturated_ticks", arm.saturated_ticks},
      {"parameter_error", arm.parameter_error},
      {"subtask_rms", OrNull(arm.subtask_rms_rad_s)},
      {"posture_rms_rad", arm.posture ? nlohmann::ordered_json(arm.posture->rms_rad) : nullptr},
      {"state", arm.state},
      {"faults", arm.faults}};
  AddSpareJoints(arm, &json);
  AddFloor(arm.floor_rms_m, arm.rms_m, &json);
  return json;
}

}  // namespace

void RunMetrics::Judge(const CriterionConfig& criterion) {
  double sum_squares_m2 = 0.0;
  int tracking = 0;
  misses.clear();
  for (ArmMetrics& arm : arms) {
    arm.standing = criterion.Stands(arm.id);
    if (criterion.Excuses(arm.id)) continue;
    if (arm.standing) {
      if (!(arm.joint_speed_max_rad_s < criterion.standing_speed_max_rad_s))
        misses.push_back({MissKind::kMoved, arm.id});
    } else {
      if (!(arm.max_m <= criterion.diverged_error_m)) arm.diverged = true;
      if (!(arm.max_m < criterion.error_max_m)) misses.push_back({MissKind::kError, arm.id});
      sum_squares_m2 += arm.rms_m * arm.rms_m;
      ++tracking;
    }
    const bool stands = arm.standing && arm.state == NameOf(ControllerState::kHold);
    if (arm.diverged) misses.push_back({MissKind::kDiverged, arm.id});
    if (!arm.faults.empty() && !stands) misses.push_back({MissKind::kStopped, arm.id});
  }
  fleet_rms_m = tracking == 0 ? 0.0 : std::sqrt(sum_squares_m2 / tracking);
  if (criterion.fleet_rms_max_m > 0.0 && !(fleet_rms_m < criterion.fleet_rms_max_m))
    misses.push_back({MissKind::kFleetRms});
  if (criterion.kind == CriterionKind::kAgreement && !(estimate_spread_m < criterion.agreement_max_m))
    misses.push_back({MissKind::kAgreement});
  ok = !arms.empty() && misses.empty();
}

void RunMetrics::CompareWithFloor(const ScenarioConfig& run) {
  std::vector<JointVector> postures_rad;
  for (const ArmMetrics& arm : arms) postures_rad.push_back(arm.floor_posture_rad);
  const FloorResult floor = Floor(run, seed, postures_rad);
  double sum_squares_m2 = 0.0;
  int tracking = 0;
  for (size_t i = 0; i < arms.size(); ++i) {
    if (arms[i].standing || run.criterion.Excuses(arms[i].id)) continue;  // not measured against the leader
    arms[i].floor_rms_m = floor.arms[i].rms_m;
    sum_squares_m2 += floor.arms[i].rms_m * floor.arms[i].rms_m;
    ++tracking;
  }
  if (tracking > 0) floor_rms_m = std::sqrt(sum_squares_m2 / tracking);
}

nlohmann::ordered_json ToJson(const RunMetrics& metrics) {
  nlohmann::ordered_json arms = nlohmann::ordered_json::array();
  for (const ArmMetrics& arm : metrics.arms) arms.push_back(ToJson(arm));
  nlohmann::ordered_json json = {{"schema", 1},
                                 {"scenario", metrics.scenario},
                                 {"scenario_file", metrics.scenario_file},
                                 {"mode", metrics.mode},
                                 {"law", NameOf(metrics.law)},
                                 {"estimator", NameOf(metrics.estimator)},
                                 {"seed", metrics.seed},
                                 {"seconds", metrics.seconds},
                                 {"window_s", {metrics.window_start_s, metrics.seconds}},
                                 {"arms", arms},
                                 {"estimate_spread_mm", metrics.estimate_spread_m * 1e3},
                                 {"fleet_rms_mm", metrics.fleet_rms_m * 1e3},
                                 {"ok", metrics.ok}};
  AddFloor(metrics.floor_rms_m, metrics.fleet_rms_m, &json);
  return json;
}

bool WriteJson(const nlohmann::ordered_json& json, const std::string& path, std::string* error) {
  return WriteWhole(
      path, [&](std::ostream& file) { file << json.dump(2) << '\n'; }, error);
}

}  // namespace armada
