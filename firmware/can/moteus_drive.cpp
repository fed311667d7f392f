#include "firmware/can/moteus_drive.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware/can/round_toward_zero.h"

namespace armada {

using moteus::Mode;

MoteusDrive::MoteusDrive(const JointDriveConfig& config) : config_(config) {}

bool MoteusDrive::Prepare(int64_t now_ns, FrameList* out) {
  if (phase_ != Phase::kArm) BringUp(now_ns, out);
  return phase_ == Phase::kArm;
}

void MoteusDrive::BringUp(int64_t now_ns, FrameList* out) {
  switch (phase_) {
    case Phase::kIdle:
      phase_ = Phase::kStop;
      [[fallthrough]];
    case Phase::kStop:
      out->Push(moteus::EncodeStop(config_));
      break;
    case Phase::kArm:
      PushTorque(0.0, out);
      break;
    case Phase::kTorque:
      return PushTorque(0.0, out);
    case Phase::kEnded:
      return;
  }
  out->Push(moteus::EncodeSetupQuery(config_));
  asked_ns_ = now_ns;
}

void MoteusDrive::RequestSample(int64_t now_ns, FrameList* out) {
  if (asked_ns_ != now_ns) out->Push(moteus::EncodeStateQuery(config_));
}

void MoteusDrive::CommandTorque(double tau_Nm, FrameList* out) {
  if (phase_ != Phase::kTorque) return;
  const double limit = config_.torque_limit_Nm;
  const double allowed_Nm = std::isfinite(tau_Nm) ? std::clamp(tau_Nm, -limit, limit) : 0.0;
  PushTorque(config_.direction * allowed_Nm / config_.gear_ratio, out);
}

void MoteusDrive::PushTorque(double motor_Nm, FrameList* out) {
  out->Push(moteus::EncodeTorque(config_, FloatTowardZero(motor_Nm)));
}

/// At once without torque. Modes 12 (zero velocity) and 15 (brake) would bring the joint to rest sooner, but
/// have no end: one more frame of a master that may be failing would have to take the power away.
void MoteusDrive::QuickStop(FrameList* out) {
  Disable(out);
}

void MoteusDrive::Disable(FrameList* out) {
  End(Refusal::kNone);
  out->Push(moteus::EncodeStop(config_));
}

Reception MoteusDrive::OnFrame(const CanFrame& frame) {
  if (!moteus::IsFromDrive(frame, config_)) return Reception::kNotMine;
  if (moteus::Setup setup; moteus::DecodeSetup(frame, &setup)) {
    OnState(setup.state, frame);
    OnSetup(setup);
    return Reception::kTaken;
  }
  moteus::State state;
  if (!moteus::DecodeState(frame, &state)) return Reception::kMalformed;
  OnState(state, frame);
  return Reception::kTaken;
}

void MoteusDrive::OnState(const moteus::State& state, const CanFrame& frame) {
  heard_ = true;
  state_ = state;
  const double joint_rad_per_turn = config_.direction * 2.0 * std::numbers::pi / config_.gear_ratio;
  sample_.position_rad = joint_rad_per_turn * state.position_turns + config_.offset_rad;
  sample_.velocity_rad_s = joint_rad_per_turn * state.velocity_turns_s;
  sample_.stamp_ns = frame.stamp_ns;
  ++sample_.sequence;
  if (phase_ == Phase::kTorque && state.mode != Mode::kPosition) {
    End(error_code() != 0 ? Refusal::kFault : Refusal::kNone);
  }
}

void MoteusDrive::OnSetup(const moteus::Setup& setup) {
  register_map_ = setup.register_map;
  watchdog_s_ = setup.watchdog_s;
  if (phase_ == Phase::kStop) {
    if (register_map_ != moteus::kRegisterMap) return End(Refusal::kRegisterMap);
    if (state_.mode == Mode::kStopped) phase_ = Phase::kArm;
  } else if (phase_ == Phase::kArm && state_.mode == Mode::kPosition) {
    if (watchdog_s_ != static_cast<float>(config_.watchdog_s)) {
      watchdog_ = DriveWatchdog::kOff;
      return End(Refusal::kWatchdog);
    }
    watchdog_ = DriveWatchdog::kProved;
    phase_ = Phase::kTorque;
  } else if (phase_ == Phase::kArm && error_code() != 0) {
    phase_ = Phase::kStop;
    if (++attempts_ == config_.bring_up_attempts) End(Refusal::kFault);
  }
}

void MoteusDrive::End(Refusal refusal) {
  phase_ = Phase::kEnded;
  refusal_ = refusal;
}

std::vector<CanFilter> MoteusDrive::Filters() const {
  const int source = config_.moteus.source_id;
  std::vector<CanFilter> filters;
  for (const uint32_t id :
       {moteus::RequestId(source, config_.node_id, false), moteus::RequestId(source, config_.node_id, true),
        moteus::AnswerId(source, config_.node_id)}) {
    filters.push_back({.id = id, .mask = 0x1FFF'FFFF, .extended = true});
    if (id <= 0x7FF) filters.push_back({.id = id, .mask = 0x7FF});
  }
  return filters;
}

void MoteusDrive::Reset() {
  phase_ = Phase::kIdle;
  refusal_ = Refusal::kNone;
  watchdog_ = DriveWatchdog::kUnproved;
  attempts_ = 0;
}

DriveState MoteusDrive::state() const {
  if (!heard_) return DriveState::kUnknown;
  if (refusal_ != Refusal::kNone) return DriveState::kFault;
  if (phase_ == Phase::kTorque) return DriveState::kTorque;
  return phase_ == Phase::kStop || phase_ == Phase::kArm ? DriveState::kEnabling : DriveState::kIdle;
}

uint32_t MoteusDrive::error_code() const {
  if (state_.mode == Mode::kFault) return state_.fault;
  return state_.mode == Mode::kPositionTimeout ? static_cast<uint32_t>(Mode::kPositionTimeout) : 0;
}

std::string MoteusDrive::Explain() const {
  const auto number = [](auto value) { return std::to_string(value); };
  if (!heard_) return "no answer of servo " + number(config_.node_id);
  if (phase_ == Phase::kTorque) return "";
  if (refusal_ == Refusal::kRegisterMap) {
    return "its register map has version " + number(register_map_) + ", known is " +
           number(moteus::kRegisterMap);
  }
  if (refusal_ == Refusal::kWatchdog) {
    return "its watchdog reads back as " + number(watchdog_s_) + " s, written was " +
           number(config_.watchdog_s) + " s";
  }
  if (state_.mode == Mode::kPositionTimeout) return "its watchdog has tripped (mode 11)";
  if (state_.mode == Mode::kFault) {
    return std::string(moteus::FaultName(state_.fault)) + " (fault " + number(state_.fault) + ")";
  }
  return "mode is " + number(static_cast<int>(state_.mode)) + ", not 10 (position)";
}

}  // namespace armada
