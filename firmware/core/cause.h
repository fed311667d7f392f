#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/core/controller_state.h"

namespace armada {

/// Why a controller leaves kRun, in the order of kCauseRules. The numbers are on the wire.
enum class Cause : int {
  kSampleLate,
  kTorquesLate,
  kErrorPassive,
  kTickOverrun,
  kErrorPassiveLong,
  kTicksMissed,
  kLeaderLost,
  kSingular,
  kSaturated,
  kNotFollowing,
  kFleetStop,
  kOperatorHold,
  kTorquesUnsent,
  kDriveLeftTorque,
  kJointLimit,
  kNonFiniteTorque,
  kEstop,
  kFeedbackStale,
  kFeedbackNonsense,
  kFeedbackFrozen,
  kBusDown,
  kBusOff,
  kBusRestarted,
  kArmingTimeout,
  kNotHolding,
  kNone,
};

inline constexpr int kCauses = static_cast<int>(Cause::kNone);

/// What a cause makes of the state, and when it is active.
struct CauseRule {
  Cause cause;
  ControllerState reaction;  ///< kDegraded, kHold, kSafeStop or kFault: at least as severe
  bool halves_gains;         ///< samples or torques come late: kDegraded halves K_s and K_x
  const char* name;          ///< as it is reported
  const char* active;        ///< when, for the documents
};

/// The event table. The worst active cause wins; docs/safety.md shows it.
inline constexpr std::array<CauseRule, kCauses> kCauseRules = {{
    {Cause::kSampleLate, ControllerState::kDegraded, true, "feedback late",
     "a joint's newest sample is older than `control.supervisor.feedback_late_s`; it is predicted"},
    {Cause::kTorquesLate, ControllerState::kDegraded, true, "torques late",
     "the torques of a tick were not all on the wire in time"},
    {Cause::kErrorPassive, ControllerState::kDegraded, true, "bus error-passive",
     "the CAN controller is error-passive"},
    {Cause::kTickOverrun, ControllerState::kDegraded, true, "tick overrun",
     "a tick's torques were ready later than `control.supervisor.overrun_share` of the period"},
    {Cause::kErrorPassiveLong, ControllerState::kHold, false, "bus error-passive for long",
     "the same for `control.supervisor.error_passive_max_s`"},
    {Cause::kTicksMissed, ControllerState::kHold, false, "ticks missed",
     "`control.supervisor.missed_in_a_row` ticks were missed one after the other, or "
     "`control.supervisor.missed_in_a_second` within a second"},
    {Cause::kLeaderLost, ControllerState::kHold, false, "leader lost",
     "nobody is heard who knows of the leader, or the news of it are older than `estimator.age_max_s`"},
    {Cause::kSingular, ControllerState::kHold, false, "near a singularity",
     "sigma_min of J below `control.supervisor.sigma_min` for `control.supervisor.sigma_min_s`, once the arm "
     "follows"},
    {Cause::kSaturated, ControllerState::kHold, false, "torque saturated",
     "once the arm follows, a joint is at its torque limit and |x - x_hat| above "
     "`control.supervisor.following_error_m` for `control.supervisor.saturated_max_s` without a break"},
    {Cause::kNotFollowing, ControllerState::kHold, false, "does not come to follow",
     "an arm that knows the leader has not come to follow it in `control.supervisor.follow_max_s`"},
    {Cause::kFleetStop, ControllerState::kHold, false, "a neighbour has stopped",
     "an arm that this one hears is in HOLD, SAFE_STOP or FAULT, or somebody that it should hear is "
     "silent, with `control.supervisor.fleet_stop = \"hold\"`"},
    {Cause::kOperatorHold, ControllerState::kHold, false, "operator: hold", "`armada ctl hold`"},
    {Cause::kTorquesUnsent, ControllerState::kSafeStop, false, "torques not sent",
     "the same as torques late in `timing.transmit_failures_max` ticks in a row"},
    {Cause::kDriveLeftTorque, ControllerState::kSafeStop, false, "drive not in torque mode",
     "a drive reports a fault, or has left torque mode, or its heartbeat is lost"},
    {Cause::kJointLimit, ControllerState::kSafeStop, false, "joint limit crossed",
     "a joint that was within its limits is `control.supervisor.joint_limit_margin_rad` beyond one"},
    {Cause::kNonFiniteTorque, ControllerState::kSafeStop, false, "torque not finite",
     "the law's torque is not finite; it is discarded"},
    {Cause::kEstop, ControllerState::kSafeStop, false, "operator: e-stop",
     "`armada ctl estop`; from INIT and MONITOR at once to FAULT"},
    {Cause::kFeedbackStale, ControllerState::kFault, false, "feedback stale",
     "a joint's newest sample, or while it has none the first request for one, is older than "
     "`timing.feedback_stale_s`"},
    {Cause::kFeedbackNonsense, ControllerState::kFault, false, "feedback makes no sense",
     "the same, and the drive has sent what no drive would send, or positions that no joint could reach; or "
     "position and speed of a joint contradict each other (`control.sensor.consistent_*`)"},
    {Cause::kFeedbackFrozen, ControllerState::kFault, false, "feedback frozen",
     "a drive repeats its last sample (`control.sensor.frozen_*`)"},
    {Cause::kBusDown, ControllerState::kFault, false, "bus down", "the CAN interface or its socket is gone"},
    {Cause::kBusOff, ControllerState::kFault, false, "bus-off", "the CAN controller has left the bus"},
    {Cause::kBusRestarted, ControllerState::kFault, false, "bus restarted",
     "the CAN controller was restarted after bus-off"},
    {Cause::kArmingTimeout, ControllerState::kFault, false, "drives not enabled in time",
     "not every drive was in torque mode `control.supervisor.arming_max_s` after the operator's arm"},
    {Cause::kNotHolding, ControllerState::kFault, false, "posture not held",
     "in HOLD, a joint is `control.supervisor.hold_drift_rad` from where it was "
     "`control.supervisor.hold_settle_s` after the beginning"},
}};

constexpr const CauseRule& RuleOf(Cause cause) {
  return kCauseRules[static_cast<size_t>(cause)];
}

constexpr const char* NameOf(Cause cause) {
  return cause == Cause::kNone ? "none" : RuleOf(cause).name;
}

/// The causes that are active in a tick.
class CauseSet {
 public:
  constexpr void Add(Cause cause) { bits_ |= Bit(cause); }
  constexpr void Set(Cause cause, bool active) {
    if (active) Add(cause);
  }
  constexpr bool Has(Cause cause) const { return (bits_ & Bit(cause)) != 0; }
  constexpr bool empty() const { return bits_ == 0; }
  constexpr CauseSet& operator|=(CauseSet other) {
    bits_ |= other.bits_;
    return *this;
  }
  constexpr uint32_t bits() const { return bits_; }

  /// The first of the most severe; kNone of an empty set.
  constexpr Cause Worst() const {
    Cause worst = Cause::kNone;
    for (const CauseRule& rule : kCauseRules) {
      if (Has(rule.cause) && (worst == Cause::kNone || rule.reaction > RuleOf(worst).reaction)) {
        worst = rule.cause;
      }
    }
    return worst;
  }

 private:
  static constexpr uint32_t Bit(Cause cause) {
    return cause == Cause::kNone ? 0 : uint32_t{1} << static_cast<int>(cause);
  }
  uint32_t bits_ = 0;
};

}  // namespace armada
