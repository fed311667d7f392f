#pragma once

#include "firmware/core/cause.h"
#include "firmware/core/parameter.h"

namespace armada {

/// What arms do that hear of another's stop, and have another path to the leader.
enum class FleetStop {
  kCarryOn,  ///< Corollary 3: whoever still has a path to the leader follows on
  kHold,     ///< all that hear of it, from arm to arm
};

constexpr auto EnumNames(FleetStop) {
  using enum FleetStop;
  return std::to_array<EnumName<FleetStop>>({{kCarryOn, "carry_on"}, {kHold, "hold"}});
}

struct SupervisorConfig {
  static constexpr int kMaxMissedInASecond = 32;

  double feedback_late_s = 0.015;
  double overrun_share = 0.8;
  double error_passive_max_s = 1.0;
  int missed_in_a_row = 2;
  int missed_in_a_second = 5;
  double sigma_min = 0.03;
  double sigma_min_s = 0.05;
  double saturated_max_s = 0.5;
  double following_error_m = 0.02;
  double following_s = 0.5;
  double follow_max_s = 15.0;
  double joint_limit_margin_rad = 0.05;
  double speed_max_rad_s = 45.0;
  FleetStop fleet_stop = FleetStop::kCarryOn;
  int good_samples = 50;
  double rest_rad_s = 0.05;
  double arming_max_s = 3.0;
  double law_ramp_s = 0.5;
  double degraded_clear_s = 0.5;
  double hold_clear_s = 1.0;
  double relay_s = 0.5;
  double stop_ramp_s = 0.3;
  double hold_rate_1_s = 10.0;
  double hold_capture_rad_s = 0.2;
  double hold_capture_max_s = 0.9;
  double hold_settle_s = 1.0;
  double hold_drift_rad = 0.2;
  double safe_stop_damping = 0.5;
  double safe_stop_rest_s = 0.1;
  double safe_stop_max_s = 1.5;
  double quick_stop_s = 0.5;

  void Visit(ParameterVisitor& parameter) {
    parameter({"feedback_late_s", "s", 1e-4, 1, "age of a joint's sample at which the arm is DEGRADED"},
              feedback_late_s);
    parameter({"overrun_share", "", 0.01, 1,
               "share of the period after which a tick's torques are late enough for DEGRADED"},
              overrun_share);
    parameter({"error_passive_max_s", "s", 0, 100,
               "time for which a CAN controller may be error-passive before the arm holds"},
              error_passive_max_s);
    parameter({"missed_in_a_row", "ticks", 1, 100, "ticks missed one after the other at which the arm holds"},
              missed_in_a_row);
    parameter({"missed_in_a_second", "ticks", 1, kMaxMissedInASecond,
               "ticks missed within a second at which the arm holds"},
              missed_in_a_second);
    parameter({"sigma_min", "m/rad", 0, 10,
               "smallest singular value of J below which a following arm holds; 0: never"},
              sigma_min);
    parameter({"sigma_min_s", "s", 0, 100, "time for which it has to be below"}, sigma_min_s);
    parameter(
        {"saturated_max_s", "s", 0, 1e6,
         "time without a break for which a joint of an arm that has come to follow may be at its torque "
         "limit while |x - x_hat| is above following_error_m"},
        saturated_max_s);
    parameter(
        {"following_error_m", "m", 0, 100, "an arm counts as following once |x - x_hat| has been below this"},
        following_error_m);
    parameter({"following_s", "s", 0, 100, "for this long"}, following_s);
    parameter({"follow_max_s", "s", 0.1, 1e6,
               "law = robust: time within which an arm that knows the leader must have come to follow it"},
              follow_max_s);
    parameter({"joint_limit_margin_rad", "rad", 0, 10,
               "way beyond q_min_rad or q_max_rad from which on a joint has crossed its limit"},
              joint_limit_margin_rad);
    parameter({"speed_max_rad_s", "rad/s", 1e-2, 1e3,
               "speed that no joint can have: a position that moves faster is not believed"},
              speed_max_rad_s);
    parameter({"fleet_stop", "", 0, 0,
               "when a neighbour stops: carry_on (while there is a path to the leader), hold"},
              fleet_stop);
    parameter({"good_samples", "ticks", 1, 10000,
               "ticks in a row with every joint's sample, and with news of every neighbour, before arming"},
              good_samples);
    parameter({"rest_rad_s", "rad/s", 1e-4, 10, "speed of the fastest joint below which an arm is at rest"},
              rest_rad_s);
    parameter({"arming_max_s", "s", 0.1, 60, "time within which all drives must be enabled"}, arming_max_s);
    parameter({"law_ramp_s", "s", 0, 10,
               "time over which the law takes over from damping and gravity after the operator's start"},
              law_ramp_s);
    parameter({"degraded_clear_s", "s", 0, 100, "time without a cause after which DEGRADED ends"},
              degraded_clear_s);
    parameter({"hold_clear_s", "s", 0, 100, "time without a cause before HOLD may be left"}, hold_clear_s);
    parameter({"relay_s", "s", 0, 10, "time for which an arm passes on that a neighbour has stopped it"},
              relay_s);
    parameter({"stop_ramp_s", "s", 0.01, 10, "HOLD: time over which the joints are brought to rest"},
              stop_ramp_s);
    parameter({"hold_rate_1_s", "1/s", 0, 50, "HOLD: rate at which a joint returns to the posture held"},
              hold_rate_1_s);
    parameter({"hold_capture_rad_s", "rad/s", 1e-3, 100,
               "HOLD: speed of the fastest joint below which the posture is taken that is held"},
              hold_capture_rad_s);
    parameter(
        {"hold_capture_max_s", "s", 0.01, 100,
         "HOLD: time after which it is taken even so: a weight that is not known well must not pull the "
         "joints on for ever"},
        hold_capture_max_s);
    parameter({"hold_settle_s", "s", 0.01, 100, "HOLD: time after which the posture must be held"},
              hold_settle_s);
    parameter({"hold_drift_rad", "rad", 1e-3, 100,
               "HOLD: way of a joint from its posture then that shows that it is not"},
              hold_drift_rad);
    parameter({"safe_stop_damping", "", 0, 1, "SAFE_STOP: share of K_s that damps"}, safe_stop_damping);
    parameter({"safe_stop_rest_s", "s", 0, 10, "SAFE_STOP: time at rest after which it ends"},
              safe_stop_rest_s);
    parameter({"safe_stop_max_s", "s", 0.01, 60, "SAFE_STOP: longest time"}, safe_stop_max_s);
    parameter(
        {"quick_stop_s", "s", 0, 60,
         "FAULT of a moving arm: time for the drives' own ramp to rest; then their power is taken away"},
        quick_stop_s);
  }
};

/// How a controller starts. Only an emulated arm may start running: the paper's random starts move.
enum class StartMode { kMonitor, kRunning };

constexpr auto EnumNames(StartMode) {
  using enum StartMode;
  return std::to_array<EnumName<StartMode>>({{kRunning, "running"}, {kMonitor, "monitor"}});
}

/// What an operator wants of an arm. The numbers are on the wire.
enum class Request : int { kNone, kArm, kStart, kHold, kReset, kEstop };

constexpr auto EnumNames(Request) {
  using enum Request;
  return std::to_array<EnumName<Request>>(
      {{kArm, "arm"}, {kStart, "start"}, {kHold, "hold"}, {kReset, "reset"}, {kEstop, "estop"}});
}

inline constexpr int kRequests = 6;

constexpr const char* NameOf(Request request) {
  constexpr const char* kNames[kRequests] = {"none", "arm", "start", "hold", "reset", "estop"};
  return kNames[static_cast<int>(request)];
}

/// Why a request is refused. The numbers are bits on the wire.
enum class Refusal : int {
  kState,
  kDrives,
  kSamples,
  kMoving,
  kFleetDiffers,
  kNeighbours,
  kNotSynced,
  kCauseActive,
  kStale,
};

inline constexpr int kRefusals = 9;

constexpr const char* TextOf(Refusal refusal) {
  constexpr const char* kTexts[kRefusals] = {
      "not possible in this state",
      "a drive is not found or not configured",
      "not every joint has given good samples for long enough",
      "the arm moves",
      "the fleet file is another one on this board",
      "a neighbour is not heard, or its fleet file is another one",
      "the estimate of the leader is not synchronized",
      "a cause is still active, or was a moment ago",
      "the request is of another time",
  };
  return kTexts[static_cast<int>(refusal)];
}

/// Bits of Refusal; none: accepted.
using Refusals = uint32_t;

constexpr Refusals Bit(Refusal refusal) {
  return Refusals{1} << static_cast<int>(refusal);
}

/// What the supervisor sees of a tick.
struct SupervisorInput {
  CauseSet causes;  ///< active in this tick
  Request request = Request::kNone;
  bool drives_ready = false;     ///< found and configured, watchdogs included
  bool drives_enabled = false;   ///< all in torque mode
  bool samples_valid = false;    ///< of every joint, or predicted
  bool samples_good = false;     ///< new ones of every joint, for control.supervisor.good_samples
  bool neighbours_good = false;  ///< the same of every neighbour, with the same fleet file
  bool synced = false;           ///< the estimate may be used for motion
  double speed_rad_s = 0.0;      ///< of the fastest joint
};

/// What takes a controller from one state to another.
enum class Trigger {
  kFaultCause,
  kSafeStopCause,
  kHoldCause,
  kDegradedCause,
  kCleared,
  kStopped,
  kDrivesReady,
  kDrivesLost,
  kDrivesEnabled,
  kStartedRunning,
  kArm,
  kStart,
  kReset,
};

/// For the documents.
constexpr const char* TextOf(Trigger trigger) {
  switch (trigger) {
    case Trigger::kFaultCause:
      return "FAULT cause";
    case Trigger::kSafeStopCause:
      return "SAFE_STOP cause";
    case Trigger::kHoldCause:
      return "HOLD cause";
    case Trigger::kDegradedCause:
      return "DEGRADED cause";
    case Trigger::kCleared:
      return "no cause for degraded_clear_s";
    case Trigger::kStopped:
      return "at rest, or safe_stop_max_s over";
    case Trigger::kDrivesReady:
      return "drives found and configured";
    case Trigger::kDrivesLost:
      return "a drive lost";
    case Trigger::kDrivesEnabled:
      return "drives enabled";
    case Trigger::kStartedRunning:
      return "emulation only";
    case Trigger::kArm:
      return "operator's arm";
    case Trigger::kStart:
      return "operator's start";
    case Trigger::kReset:
      break;
  }
  return "operator's reset";
}

struct Transition {
  ControllerState from;
  Trigger trigger;
  ControllerState to;
};

/// Every way from one state to another, of each state the most severe first: the first whose trigger is
/// active is taken. Nothing gives torque again without an operator but a DEGRADED that has cleared.
inline constexpr std::array<Transition, 25> kTransitions = {{
    {ControllerState::kInit, Trigger::kFaultCause, ControllerState::kFault},
    {ControllerState::kInit, Trigger::kSafeStopCause, ControllerState::kFault},
    {ControllerState::kInit, Trigger::kStartedRunning, ControllerState::kRun},
    {ControllerState::kInit, Trigger::kDrivesReady, ControllerState::kMonitor},
    {ControllerState::kMonitor, Trigger::kSafeStopCause, ControllerState::kFault},
    {ControllerState::kMonitor, Trigger::kDrivesLost, ControllerState::kInit},
    {ControllerState::kMonitor, Trigger::kArm, ControllerState::kArming},
    {ControllerState::kArming, Trigger::kFaultCause, ControllerState::kFault},
    {ControllerState::kArming, Trigger::kSafeStopCause, ControllerState::kSafeStop},
    {ControllerState::kArming, Trigger::kDrivesEnabled, ControllerState::kHold},
    {ControllerState::kRun, Trigger::kFaultCause, ControllerState::kFault},
    {ControllerState::kRun, Trigger::kSafeStopCause, ControllerState::kSafeStop},
    {ControllerState::kRun, Trigger::kHoldCause, ControllerState::kHold},
    {ControllerState::kRun, Trigger::kDegradedCause, ControllerState::kDegraded},
    {ControllerState::kDegraded, Trigger::kFaultCause, ControllerState::kFault},
    {ControllerState::kDegraded, Trigger::kSafeStopCause, ControllerState::kSafeStop},
    {ControllerState::kDegraded, Trigger::kHoldCause, ControllerState::kHold},
    {ControllerState::kDegraded, Trigger::kCleared, ControllerState::kRun},
    {ControllerState::kHold, Trigger::kFaultCause, ControllerState::kFault},
    {ControllerState::kHold, Trigger::kSafeStopCause, ControllerState::kSafeStop},
    {ControllerState::kHold, Trigger::kReset, ControllerState::kInit},
    {ControllerState::kHold, Trigger::kStart, ControllerState::kRun},
    {ControllerState::kSafeStop, Trigger::kFaultCause, ControllerState::kFault},
    {ControllerState::kSafeStop, Trigger::kStopped, ControllerState::kFault},
    {ControllerState::kFault, Trigger::kReset, ControllerState::kInit},
}};

/// The state machine of one arm's safety: causes and an operator's requests in, the state out. Everything it
/// does is in kCauseRules and kTransitions; here are only the times. Fixed memory.
class Supervisor {
 public:
  Supervisor(const SupervisorConfig& config, StartMode start) : config_(config), start_(start) {}

  /// One tick, `elapsed_s` after the last one.
  ControllerState Step(const SupervisorInput& in, double elapsed_s);

  ControllerState state() const { return state_; }
  /// What it was that took the controller out of kRun, or keeps it in kDegraded; kNone otherwise.
  Cause cause() const { return cause_; }
  /// Why the request of the last tick was refused; 0 when it was not.
  Refusals refusals() const { return refusals_; }
  /// Whether kDegraded halves the gains.
  bool halves_gains() const { return state_ == ControllerState::kDegraded && RuleOf(cause_).halves_gains; }
  /// The law's share of the torque in kRun and kDegraded; the rest is damping and gravity.
  double law_share() const { return law_share_; }
  /// Whether neighbours are to know that this arm has stopped.
  bool announces_stop() const;
  /// One bit for each of kTransitions: taken since the start.
  uint32_t transitions_taken() const { return taken_; }

 private:
  CauseSet Active(const SupervisorInput& in) const;
  Refusals Judge(const SupervisorInput& in) const;
  bool IsActive(Trigger trigger, const SupervisorInput& in, Cause worst) const;
  void Enter(ControllerState state, Cause cause);

  SupervisorConfig config_;
  StartMode start_;
  ControllerState state_ = ControllerState::kInit;
  Cause cause_ = Cause::kNone;
  Refusals refusals_ = 0;
  uint32_t taken_ = 0;
  double law_share_ = 0.0;
  double in_state_s_ = 0.0;
  double clear_s_ = 0.0;      ///< since the last cause
  double own_clear_s_ = 1e9;  ///< since the last one that is not a neighbour's stop, of HOLD or worse
  double at_rest_s_ = 0.0;
};

}  // namespace armada
