#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "firmware/app/fleet.h"
#include "firmware/core/parameter.h"
#include "hil/emulated_drive.h"
#include "hil/fault.h"

namespace armada {

/// x_0(t) per axis = offset + amplitude sin(2 pi frequency t + phase).
struct SineAxisConfig {
  double offset_m = 0.0;
  double amplitude_m = 0.0;
  double frequency_hz = 0.0;
  double phase_rad = 0.0;

  void Visit(ParameterVisitor& parameter) {
    parameter({"offset_m", "m", -100, 100, "centre of the motion"}, offset_m);
    parameter({"amplitude_m", "m", 0, 100, "amplitude of the motion"}, amplitude_m);
    parameter({"frequency_hz", "Hz", 0, 100, "frequency of the motion"}, frequency_hz);
    parameter({"phase_rad", "rad", -7, 7, "phase of the sine at t = 0"}, phase_rad);
  }
};

enum class LeaderKind { kNone, kSine, kWaypoints };

constexpr auto EnumNames(LeaderKind) {
  using enum LeaderKind;
  return std::to_array<EnumName<LeaderKind>>({{kNone, "none"}, {kSine, "sine"}, {kWaypoints, "waypoints"}});
}

struct LeaderConfig {
  LeaderKind kind = LeaderKind::kSine;
  double rate_hz = 100.0;
  std::vector<SineAxisConfig> axes;              ///< sine: one an axis
  std::vector<std::vector<double>> waypoints_m;  ///< waypoints: visited in turn, at rest in each
  double speed_m_s = 0.5;
  double acceleration_m_s2 = 2.0;
  double jerk_m_s3 = 15.0;
  double dwell_s = 0.0;
  bool loop = true;

  void Visit(ParameterVisitor& parameter) {
    parameter({"kind", "", 0, 0, "leader: none, sine, waypoints"}, kind);
    parameter({"rate_hz", "Hz", 1, 1000, "messages a second on LEADER"}, rate_hz);
    parameter({"speed_m_s", "m/s", 1e-3, 100, "waypoints: bound on the speed along the path"}, speed_m_s);
    parameter({"acceleration_m_s2", "m/s^2", 1e-3, 1e3, "waypoints: bound on the acceleration"},
              acceleration_m_s2);
    parameter({"jerk_m_s3", "m/s^3", 1e-3, 1e4, "waypoints: bound on the jerk"}, jerk_m_s3);
    parameter({"dwell_s", "s", 0, 1e3, "waypoints: time at rest in each"}, dwell_s);
    parameter({"loop", "", 0, 1, "waypoints: from the last back to the first, for ever"}, loop);
    parameter({"waypoints_m", "m", -100, 100, "waypoints: [x, y] of each, visited in turn"}, waypoints_m);
    parameter.List({"axis", "sine: motion along one axis, x and then y"}, axes);
  }
};

enum class StartKind {
  kBox,         ///< the paper's: every element at random in its range
  kNearLeader,  ///< at rest, the end effector near x_0(0), the elbow bent
};

constexpr auto EnumNames(StartKind) {
  using enum StartKind;
  return std::to_array<EnumName<StartKind>>({{kBox, "box"}, {kNearLeader, "near_leader"}});
}

struct StartConfig {
  StartKind kind = StartKind::kBox;
  double q_range_rad = 5.0;
  double dq_range_rad_s = 5.0;
  double zeta_range = 5.0;
  TaskVector zeta_x_centre_m = TaskVector::Zero(PlanarArm::kTaskDim);
  double theta_hat_max = 5.0;
  double near_leader_m = 0.1;
  std::string learned = "none";
  StartMode mode = StartMode::kRunning;

  void Visit(ParameterVisitor& parameter) {
    parameter({"kind", "", 0, 0, "start states: box (the paper's), near_leader (at rest, near the leader)"},
              kind);
    parameter({"q_range_rad", "rad", 0, 100, "box: q(0) uniform in +- this"}, q_range_rad);
    parameter({"dq_range_rad_s", "rad/s", 0, 100, "box: dq(0) uniform in +- this"}, dq_range_rad_s);
    parameter({"zeta_range", "m, m/s, m/s^2", 0, 100, "every element of zeta(0) uniform in +- this"},
              zeta_range);
    parameter({"zeta_x_centre_m", "m", -100, 100,
               "x part of zeta(0) lies around this, unless the start is near_leader"},
              zeta_x_centre_m);
    parameter({"theta_hat_max", "kg m^2", 0, 1e3, "every element of theta_hat(0) uniform in [0, this]"},
              theta_hat_max);
    parameter({"near_leader_m", "m", 0, 10, "near_leader: start within this of x_0(0) on each axis"},
              near_leader_m);
    parameter(
        {"learned", "", 0, 0,
         "warm start: folder with what arms have learnt, arm_<id>.toml, in place of theta_hat(0); relative "
         "to this file"},
        learned);
    parameter({"mode", "", 0, 0,
               "how the boards start: running, or monitor, from where an operator arms and starts them"},
              mode);
  }
};

enum class DisturbanceKind { kNone, kUniform, kConstant, kSine, kAdversarial };

constexpr auto EnumNames(DisturbanceKind) {
  using enum DisturbanceKind;
  return std::to_array<EnumName<DisturbanceKind>>({{kNone, "none"},
                                                   {kUniform, "uniform"},
                                                   {kConstant, "constant"},
                                                   {kSine, "sine"},
                                                   {kAdversarial, "adversarial"}});
}

struct DisturbanceConfig {
  DisturbanceKind kind = DisturbanceKind::kUniform;
  double amplitude_Nm = 40.0;
  double hold_s = 0.01;
  double frequency_hz = 0.5;

  void Visit(ParameterVisitor& parameter) {
    parameter({"kind", "", 0, 0,
               "d(t) of (1.1): none, uniform (random, held), constant, sine, adversarial (pushes away from "
               "the leader)"},
              kind);
    parameter({"amplitude_Nm", "N m", 0, 1e5, "largest disturbance of each joint"}, amplitude_Nm);
    parameter({"hold_s", "s", 1e-4, 1e3, "uniform, adversarial: time for which a value is held"}, hold_s);
    parameter({"frequency_hz", "Hz", 0, 1e3,
               "sine: frequency of the first joint; each further one is 0.2 Hz faster"},
              frequency_hz);
  }
};

/// A link that fails: messages of one node do not reach one arm for some time.
struct LostLinkConfig {
  static constexpr double kForGood_s = 1e6;

  int from = -1;
  int to = 0;
  double at_s = -1.0;
  double until_s = kForGood_s;

  void Visit(ParameterVisitor& parameter) {
    parameter({"from", "", 0, kMaxArms, "id of the arm that is no longer heard; 0: the leader"}, from);
    parameter({"to", "", 1, kMaxArms, "id of the arm that no longer hears it"}, to);
    parameter({"at_s", "s", 0, kForGood_s, "time of the first message that is lost"}, at_s);
    parameter({"until_s", "s", 0, kForGood_s, "time of the first message that arrives again"}, until_s);
  }
};

/// The link between the boards in virtual time.
struct NetworkConfig {
  int delay_ticks = 0;
  double loss = 0.0;
  std::vector<LostLinkConfig> lost;

  /// Whether what node `from` (0: the leader) sends at `t_s` never reaches arm `to`.
  bool IsLost(int from, int to, double t_s) const {
    return std::any_of(lost.begin(), lost.end(), [&](const LostLinkConfig& link) {
      return link.from == from && link.to == to && t_s >= link.at_s - 1e-9 && t_s < link.until_s - 1e-9;
    });
  }

  void Visit(ParameterVisitor& parameter) {
    parameter({"delay_ticks", "ticks", 0, 50, "control periods that a message is under way, beside none"},
              delay_ticks);
    parameter({"loss", "", 0, 1, "share of messages lost, each receiver on its own"}, loss);
    parameter.List({"lost", "a link that fails for some time or for good"}, lost);
  }
};

enum class CriterionKind {
  kTracking,   ///< every arm stays near the leader in the window
  kAgreement,  ///< leaderless: estimates agree and every arm stays near the agreed point
};

constexpr auto EnumNames(CriterionKind) {
  using enum CriterionKind;
  return std::to_array<EnumName<CriterionKind>>({{kTracking, "tracking"}, {kAgreement, "agreement"}});
}

struct CriterionConfig {
  CriterionKind kind = CriterionKind::kTracking;
  double error_max_m = 0.02;
  double diverged_error_m = 0.2;
  double fleet_rms_max_m = 0.0;
  double agreement_max_m = 0.001;
  std::vector<int> standing;
  double standing_speed_max_rad_s = 1.0;
  std::vector<int> excused;

  /// Whether this arm is to stand still in the window, having lost the leader.
  bool Stands(int arm_id) const {
    return std::find(standing.begin(), standing.end(), arm_id) != standing.end();
  }
  /// Whether a fault takes this arm out.
  bool Excuses(int arm_id) const {
    return std::find(excused.begin(), excused.end(), arm_id) != excused.end();
  }

  void Visit(ParameterVisitor& parameter) {
    parameter({"kind", "", 0, 0, "what ok means: tracking, agreement (leaderless)"}, kind);
    parameter({"error_max_m", "m", 0, 100, "largest error of any arm in the window; also the settling band"},
              error_max_m);
    parameter({"diverged_error_m", "m", 0, 1e6, "error in the window beyond which an arm counts as diverged"},
              diverged_error_m);
    parameter({"fleet_rms_max_m", "m", 0, 100, "largest fleet RMS; 0: no bound"}, fleet_rms_max_m);
    parameter(
        {"agreement_max_m", "m", 0, 100, "agreement: largest distance between two estimates in the window"},
        agreement_max_m);
    parameter({"standing", "", 1, kMaxArms,
               "ids of arms that lose the leader: they must stand still in the window, and are not measured "
               "against it"},
              standing);
    parameter({"standing_speed_max_rad_s", "rad/s", 0, 1e3,
               "largest joint speed of an arm that stands still; the disturbance goes on"},
              standing_speed_max_rad_s);
    parameter({"excused", "", 1, kMaxArms, "ids of arms that a fault takes out: they are not judged"},
              excused);
  }
};

struct PlantConfig {
  double step_s = 0.001;
  double diverged_rad_s = 1e4;
  double brake_s = 0.1;

  void Visit(ParameterVisitor& parameter) {
    parameter({"step_s", "s", 1e-6, 0.001, "largest integration step of the plant (RK4)"}, step_s);
    parameter(
        {"diverged_rad_s", "rad/s", 1, 1e9, "joint speed at which an arm counts as diverged and is frozen"},
        diverged_rad_s);
    parameter({"brake_s", "s", 0, 10, "time with all drives off after which the brakes have closed"},
              brake_s);
  }
};

/// What an operator asks of boards at a time of the run.
struct OperatorConfig {
  double at_s = -1.0;
  int arm = 0;
  Request request = Request::kNone;

  void Visit(ParameterVisitor& parameter) {
    parameter({"at_s", "s", 0, 1e6, "time at which the operator asks"}, at_s);
    parameter({"arm", "", 0, kMaxArms, "id of the arm; 0: every arm"}, arm);
    parameter({"request", "", 0, 0, "what of it, as by `armada ctl`: arm, start, hold, reset, estop"},
              request);
  }
};

/// A run: a fleet, a leader, and the world around them.
struct ScenarioConfig {
  std::string name;
  std::string file;
  FleetConfig fleet;
  double seconds = 30.0;
  double window_start_s = 15.0;
  LeaderConfig leader;
  StartConfig start;
  DisturbanceConfig disturbance;
  EmulatedDriveConfig drive;
  NetworkConfig network;
  PlantConfig plant;
  CriterionConfig criterion;
  std::vector<FaultConfig> faults;
  std::vector<OperatorConfig> operations;
  std::vector<std::optional<ArmInitialState>> learned;  ///< from start.learned, by arm; empty: none

  void Visit(ParameterVisitor& parameter) {
    parameter({"seconds", "s", 0.1, 1e6, "length of the run"}, seconds);
    parameter({"window_start_s", "s", 0, 1e6,
               "start of the window over which errors are measured; its end is the run's"},
              window_start_s);
    parameter.Table("leader", leader);
    parameter.Table("start", start);
    parameter.Table("disturbance", disturbance);
    parameter.Table("drive", drive);
    parameter.Table("network", network);
    parameter.Table("plant", plant);
    parameter.Table("criterion", criterion);
    parameter.List({"fault", "something that goes wrong at a time of the run"}, faults);
    parameter.List({"operator", "what an operator asks at a time of the run; in virtual time only"},
                   operations);
  }
};

}  // namespace armada
