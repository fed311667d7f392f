#pragma once

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "hil/scenario.h"

namespace armada {

struct EstimatorRms {
  double x_m = 0.0;
  double v_m_s = 0.0;
  double a_m_s2 = 0.0;
};

/// Largest errors in the window on any axis.
struct EstimatorMax {
  double x_m = 0.0;
  double v_m_s = 0.0;
  double a_m_s2 = 0.0;

  /// Takes the error of one tick.
  void Update(const Zeta& estimate, const Zeta& truth) {
    const auto widen = [](double& largest, const TaskVector& error) {
      largest = std::max(largest, error.cwiseAbs().maxCoeff());
    };
    widen(x_m, estimate.x_m - truth.x_m);
    widen(v_m_s, estimate.v_m_s - truth.v_m_s);
    widen(a_m_s2, estimate.a_m_s2 - truth.a_m_s2);
  }
};

/// How near a posture came to its goal, in the window.
struct PostureMetrics {
  int joint = 0;  ///< from 1
  double goal_rad = 0.0;
  double rms_rad = 0.0;  ///< distance from the nearest goal
  double max_rad = 0.0;
};

/// How near an arm's links came to its obstacles, in the window.
struct ClearanceMetrics {
  double wanted_m = 0.0;  ///< clearance that the configuration asks for
  double min_m = 0.0;     ///< negative: within an obstacle
};

/// How near an arm's joints came to their limits, in the window.
struct LimitMetrics {
  JointVector q_min_rad, q_max_rad;  ///< empty: none
  double margin_min_rad = 0.0;       ///< negative: beyond a limit
};

/// Result of one arm in one run: an entry of "arms" in metrics.json.
struct ArmMetrics {
  int id = 0;
  int dof = 0;
  SubtaskKind subtask = SubtaskKind::kNone;
  bool diverged = false;  ///< left every bound of speed, or of error in the window
  std::optional<double> settled_s;
  double rms_m = 0.0;
  double max_m = 0.0;
  std::optional<double> max_at_s;     ///< when it was max_m
  std::optional<double> beyond_at_s;  ///< first time in the window beyond criterion.error_max_m
  std::optional<double> floor_rms_m;  ///< unavoidable part of rms_m, where it was computed
  EstimatorRms estimator_rms;
  EstimatorMax estimator_max;
  double joint_speed_max_rad_s = 0.0;  ///< in the window
  bool standing = false;               ///< by the criterion: it lost the leader, and must stand still
  double torque_max_Nm = 0.0;
  int saturated_ticks = 0;
  double parameter_error = 0.0;             ///< |theta_hat - theta| / |theta| at the end
  std::optional<double> subtask_rms_rad_s;  ///< RMS of |e_s| in the window; none without a subtask
  std::optional<PostureMetrics> posture;
  std::optional<ClearanceMetrics> clearance;
  std::optional<LimitMetrics> limits;
  JointVector floor_posture_rad;  ///< joints at the tick at which the arm's floor begins
  std::string state = "INIT";
  std::vector<std::string> faults;
};

/// What a run misses of its scenario's criterion.
enum class MissKind {
  kStopped,   ///< an arm has a fault
  kDiverged,  ///< an arm left every bound
  kError,     ///< an arm's max_m is not below criterion.error_max_m
  kMoved,     ///< an arm that was to stand still moved
  kFleetRms,
  kAgreement,
};

struct Miss {
  MissKind kind;
  int arm_id = 0;  ///< 0: the fleet
};

/// Result of a run: metrics.json.
struct RunMetrics {
  std::string scenario;
  std::string scenario_file;
  std::string mode;  ///< "sim" or "run"
  LawKind law = LawKind::kRobust;
  EstimatorKind estimator = EstimatorKind::kPredictive;
  uint64_t seed = 0;
  double seconds = 0.0;
  double window_start_s = 0.0;
  std::vector<ArmMetrics> arms;
  double estimate_spread_m = 0.0;  ///< largest distance between two estimates of x in the window
  double fleet_rms_m = 0.0;
  std::optional<double> floor_rms_m;  ///< unavoidable part of fleet_rms_m, where it was computed
  std::vector<Miss> misses;           ///< of the criterion, in the order of the arms
  bool ok = false;

  /// Fills fleet_rms_m, misses, ok and, of each arm, standing and by its error diverged, from the arms by the
  /// scenario's criterion.
  void Judge(const CriterionConfig& criterion);
  /// Sets fleet and arms beside the floor (host/floor/floor.h) of the scenario that this is the run of, in
  /// the arms' postures.
  void CompareWithFloor(const ScenarioConfig& run);
};

/// The schema of docs/metrics.md, SI units but for names that say millimetres.
nlohmann::ordered_json ToJson(const RunMetrics& metrics);

/// One JSON value, indented, whole or not at all. False with *error set.
bool WriteJson(const nlohmann::ordered_json& json, const std::string& path, std::string* error);

}  // namespace armada
