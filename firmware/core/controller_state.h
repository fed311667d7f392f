#pragma once

namespace armada {

/// State of an arm's controller, see the transitions in supervisor.h. The numbers are on the wire.
enum class ControllerState : int {
  kInit,      ///< no torque, drives disabled: not all of them are found and configured
  kMonitor,   ///< no torque, drives disabled: everything else runs
  kArming,    ///< drives are being enabled; each that is holds its joint
  kRun,       ///< full law
  kDegraded,  ///< law without adaptation; with half the gains where samples or torques come late
  kHold,      ///< to rest in joint space, then posture held: no network, no Jacobian
  kSafeStop,  ///< damping and gravity until at rest
  kFault,     ///< drives told to stop; latched
};

inline constexpr int kControllerStates = 8;

constexpr const char* NameOf(ControllerState state) {
  switch (state) {
    case ControllerState::kInit:
      return "INIT";
    case ControllerState::kMonitor:
      return "MONITOR";
    case ControllerState::kArming:
      return "ARMING";
    case ControllerState::kRun:
      return "RUN";
    case ControllerState::kDegraded:
      return "DEGRADED";
    case ControllerState::kHold:
      return "HOLD";
    case ControllerState::kSafeStop:
      return "SAFE_STOP";
    case ControllerState::kFault:
      break;
  }
  return "FAULT";
}

/// Whether the controller gives torques in this state.
constexpr bool GivesTorque(ControllerState state) {
  using enum ControllerState;
  return state == kArming || state == kRun || state == kDegraded || state == kHold || state == kSafeStop;
}

/// Whether the arm follows the leader in this state.
constexpr bool Follows(ControllerState state) {
  return state == ControllerState::kRun || state == ControllerState::kDegraded;
}

/// Whether something has stopped an arm that follows: `faults` of metrics.json says what.
constexpr bool HasStopped(ControllerState state) {
  using enum ControllerState;
  return state == kHold || state == kSafeStop || state == kFault;
}

}  // namespace armada
