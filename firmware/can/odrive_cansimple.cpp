#include "firmware/can/odrive_cansimple.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace armada {
namespace {

using odrive::AxisState;

/// A heartbeat may have been under way when the bring-up was sent; the second one after it has seen it.
constexpr int kHeartbeatsToConfirm = 2;

/// Rounds toward zero: a torque at the limit does not pass it by rounding.
float ToFloatTowardZero(double value) {
  const auto nearest = static_cast<float>(value);
  return std::abs(static_cast<double>(nearest)) > std::abs(value) ? std::nextafter(nearest, 0.0f) : nearest;
}

}  // namespace

ODriveCanSimple::ODriveCanSimple(const JointDriveConfig& config, odrive::Firmware firmware)
    : config_(config), firmware_(firmware) {}

void ODriveCanSimple::Enable(FrameList* out) {
  if (phase_ != Phase::kBringUp || !heard_) return;
  if (attempts_ > 0 && heartbeats_since_attempt_ < kHeartbeatsToConfirm) return;
  if (attempts_ == kMaxAttempts && heartbeat_.error != 0) {
    phase_ = Phase::kEnded;
    return;
  }
  const int node = config_.node_id;
  out->Push(odrive::EncodeClearErrors(node));
  out->Push(
      odrive::EncodeSetControllerMode(node, {odrive::ControlMode::kTorque, odrive::InputMode::kPassthrough}));
  out->Push(odrive::EncodeSetInputTorque(node, 0.0f));  // the drive keeps an old one through a disarm
  out->Push(odrive::EncodeSetAxisState(node, AxisState::kClosedLoop));
  attempts_ = std::min(attempts_ + 1, kMaxAttempts);
  heartbeats_since_attempt_ = 0;
}

void ODriveCanSimple::RequestSample(FrameList* out) {
  out->Push(odrive::EncodeEncoderRequest(config_.node_id));
}

void ODriveCanSimple::CommandTorque(double tau_Nm, FrameList* out) {
  const double limit = config_.torque_limit_Nm;
  const double allowed_Nm = std::isfinite(tau_Nm) ? std::clamp(tau_Nm, -limit, limit) : 0.0;
  const double motor_Nm = config_.direction * allowed_Nm / config_.gear_ratio;
  out->Push(odrive::EncodeSetInputTorque(config_.node_id, ToFloatTowardZero(motor_Nm)));
}

void ODriveCanSimple::Disable(FrameList* out) {
  phase_ = Phase::kEnded;
  out->Push(odrive::EncodeSetAxisState(config_.node_id, AxisState::kIdle));
}

bool ODriveCanSimple::OnFrame(const CanFrame& frame) {
  if (odrive::Heartbeat heartbeat; odrive::DecodeHeartbeat(frame, config_.node_id, firmware_, &heartbeat)) {
    OnHeartbeat(heartbeat);
    return true;
  }
  odrive::EncoderEstimates estimates;
  if (!odrive::DecodeEncoderEstimates(frame, config_.node_id, &estimates)) return false;
  const double joint_rad_per_turn = config_.direction * 2.0 * std::numbers::pi / config_.gear_ratio;
  sample_.position_rad = joint_rad_per_turn * estimates.position_turns + config_.offset_rad;
  sample_.velocity_rad_s = joint_rad_per_turn * estimates.velocity_turns_s;
  sample_.stamp_ns = frame.stamp_ns;
  ++sample_.sequence;
  return true;
}

void ODriveCanSimple::OnHeartbeat(const odrive::Heartbeat& heartbeat) {
  heartbeat_ = heartbeat;
  heard_ = true;
  heartbeats_since_attempt_ = std::min(heartbeats_since_attempt_ + 1, kHeartbeatsToConfirm);
  const bool torque = heartbeat.state == AxisState::kClosedLoop && heartbeat.error == 0;
  if (phase_ == Phase::kBringUp && attempts_ > 0 && torque) phase_ = Phase::kTorque;
  if (phase_ == Phase::kTorque && !torque) phase_ = Phase::kEnded;
}

DriveState ODriveCanSimple::state() const {
  if (!heard_) return DriveState::kUnknown;
  if (phase_ == Phase::kTorque) return DriveState::kTorque;
  if (phase_ == Phase::kBringUp) return attempts_ > 0 ? DriveState::kEnabling : DriveState::kIdle;
  return heartbeat_.error != 0 ? DriveState::kFault : DriveState::kIdle;
}

void ODriveCanSimple::Reset() {
  phase_ = Phase::kBringUp;
  attempts_ = 0;
}

}  // namespace armada
