#include "firmware/core/supervisor.h"

#include <algorithm>

namespace armada {
namespace {

// Sums of periods are compared with a grain of rounding.
constexpr double kGrain_s = 1e-9;

}  // namespace

ControllerState Supervisor::Step(const SupervisorInput& in, double elapsed_s) {
  in_state_s_ += elapsed_s;
  const CauseSet active = Active(in);
  const Cause worst = active.Worst();
  clear_s_ = active.empty() ? clear_s_ + elapsed_s : 0.0;
  CauseSet neighbours_stop;
  neighbours_stop.Add(Cause::kFleetStop);
  const bool own = worst != Cause::kNone && RuleOf(worst).reaction >= ControllerState::kHold &&
                   active.bits() != neighbours_stop.bits();
  own_clear_s_ = own ? 0.0 : own_clear_s_ + elapsed_s;
  at_rest_s_ = in.speed_rad_s < config_.rest_rad_s ? at_rest_s_ + elapsed_s : 0.0;
  refusals_ = Judge(in);

  for (size_t i = 0; i < kTransitions.size(); ++i) {
    if (kTransitions[i].from != state_ || !IsActive(kTransitions[i].trigger, in, worst)) continue;
    taken_ |= uint32_t{1} << i;
    Enter(kTransitions[i].to, worst);
    break;
  }

  if (state_ == ControllerState::kDegraded && worst != Cause::kNone) cause_ = worst;
  const double ramp = config_.law_ramp_s > elapsed_s ? elapsed_s / config_.law_ramp_s : 1.0;
  law_share_ = Follows(state_) ? std::min(1.0, law_share_ + ramp) : 0.0;
  return state_;
}

// Without torque nothing can go wrong but that the operator wants it to stay so, or that an arm that is to
// start running cannot.
CauseSet Supervisor::Active(const SupervisorInput& in) const {
  CauseSet active;
  const bool starts_running = state_ == ControllerState::kInit && start_ == StartMode::kRunning;
  if (GivesTorque(state_) || starts_running) active = in.causes;
  active.Set(Cause::kEstop, in.request == Request::kEstop);
  active.Set(Cause::kOperatorHold, in.request == Request::kHold && Follows(state_));
  const bool late = state_ == ControllerState::kArming && in_state_s_ > config_.arming_max_s + kGrain_s;
  active.Set(Cause::kArmingTimeout, late || (starts_running && !in.drives_enabled));
  return active;
}

// What is so already is not refused.
Refusals Supervisor::Judge(const SupervisorInput& in) const {
  using enum ControllerState;
  Refusals refusals = 0;
  const auto refuse_unless = [&](bool condition, Refusal refusal) {
    if (!condition) refusals |= Bit(refusal);
  };
  const bool at_rest = in.speed_rad_s < config_.rest_rad_s;
  switch (in.request) {
    case Request::kNone:
    case Request::kEstop:
      break;
    case Request::kArm:
      if (state_ == kArming || state_ == kHold || Follows(state_)) break;
      if (state_ != kMonitor) return Bit(Refusal::kState);
      refuse_unless(in.drives_ready, Refusal::kDrives);
      refuse_unless(in.samples_good, Refusal::kSamples);
      refuse_unless(at_rest, Refusal::kMoving);
      refuse_unless(in.causes.empty(), Refusal::kCauseActive);
      break;
    case Request::kStart:
      if (Follows(state_)) break;
      if (state_ != kHold) return Bit(Refusal::kState);
      refuse_unless(in.neighbours_good, Refusal::kNeighbours);
      refuse_unless(in.synced, Refusal::kNotSynced);
      refuse_unless(clear_s_ > config_.hold_clear_s - kGrain_s, Refusal::kCauseActive);
      break;
    case Request::kHold:
      refuse_unless(Follows(state_) || state_ == kHold, Refusal::kState);
      break;
    case Request::kReset:
      if (state_ == kInit || state_ == kMonitor) break;
      if (state_ != kHold && state_ != kFault) return Bit(Refusal::kState);
      refuse_unless(state_ != kHold || at_rest, Refusal::kMoving);
      break;
  }
  return refusals;
}

bool Supervisor::IsActive(Trigger trigger, const SupervisorInput& in, Cause worst) const {
  const auto wants = [&](ControllerState reaction) {
    return worst != Cause::kNone && RuleOf(worst).reaction == reaction;
  };
  const auto accepted = [&](Request request) { return in.request == request && refusals_ == 0; };
  switch (trigger) {
    case Trigger::kFaultCause:
      return wants(ControllerState::kFault);
    case Trigger::kSafeStopCause:
      return wants(ControllerState::kSafeStop);
    case Trigger::kHoldCause:
      return wants(ControllerState::kHold);
    case Trigger::kDegradedCause:
      return wants(ControllerState::kDegraded);
    case Trigger::kCleared:
      return clear_s_ > config_.degraded_clear_s - kGrain_s;
    case Trigger::kStopped:
      return std::min(at_rest_s_, in_state_s_) > config_.safe_stop_rest_s - kGrain_s ||
             in_state_s_ > config_.safe_stop_max_s - kGrain_s;
    case Trigger::kDrivesReady:
      return start_ == StartMode::kMonitor && in.drives_ready;
    case Trigger::kDrivesLost:
      return !in.drives_ready;
    case Trigger::kDrivesEnabled:
      return in.drives_enabled;
    case Trigger::kStartedRunning:
      return start_ == StartMode::kRunning && in.drives_enabled && in.samples_valid;
    case Trigger::kArm:
      return accepted(Request::kArm);
    case Trigger::kStart:
      return accepted(Request::kStart);
    case Trigger::kReset:
      return accepted(Request::kReset);
  }
  return false;
}

void Supervisor::Enter(ControllerState state, Cause cause) {
  // What follows from a safe stop is not why it came.
  if (state_ != ControllerState::kSafeStop) cause_ = cause;
  if (state_ == ControllerState::kInit && state == ControllerState::kRun) law_share_ = 1.0;
  if (state == ControllerState::kInit) start_ = StartMode::kMonitor;  // after a reset no arm starts running
  state_ = state;
  in_state_s_ = 0.0;
}

bool Supervisor::announces_stop() const {
  switch (state_) {
    case ControllerState::kSafeStop:
    case ControllerState::kFault:
      return true;
    case ControllerState::kHold:
      return own_clear_s_ < config_.hold_clear_s ||
             (cause_ == Cause::kFleetStop && in_state_s_ < config_.relay_s);
    default:
      return false;
  }
}

}  // namespace armada
