#include "firmware/can/odrive_cansimple.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware/can/round_toward_zero.h"
#include "firmware/can/value_format.h"

namespace armada {
namespace {

using odrive::AxisState;

/// A heartbeat may have been under way when the drive was armed; the second one after it has seen it.
constexpr int kHeartbeatsToConfirm = 2;

}  // namespace

ODriveCanSimple::ODriveCanSimple(const JointDriveConfig& config)
    : config_(config),
      firmware_(odrive::FirmwareOf(config.profile)),
      heartbeats_to_trip_(kHeartbeatsToConfirm +
                          static_cast<int>(std::ceil(config.watchdog_s / config.odrive.heartbeat_s))) {}

/// There is nothing to configure, and the watchdog shows only on an armed axis. One that an earlier master
/// has left armed is disarmed.
bool ODriveCanSimple::Prepare(int64_t now_ns, FrameList* out) {
  if (!heard_ || IsSilent(now_ns)) return false;
  const bool armed = heartbeat_.state == AxisState::kClosedLoop;
  if (armed) out->Push(odrive::EncodeSetAxisState(config_.node_id, AxisState::kIdle));
  return phase_ == Phase::kBringUp && watchdog_ != DriveWatchdog::kOff && !armed;
}

void ODriveCanSimple::BringUp(int64_t /*now_ns*/, FrameList* out) {
  if (phase_ == Phase::kTorque) return CommandTorque(0.0, out);
  if (phase_ == Phase::kEnded || !heard_) return;
  const bool proving = watchdog_ == DriveWatchdog::kUnproved;
  if (proving && attempts_ > 0 && heartbeats_since_attempt_ >= heartbeats_to_trip_ &&
      heartbeat_.state == AxisState::kClosedLoop) {
    watchdog_ = DriveWatchdog::kOff;
    return Disable(out);
  }
  const int patience = proving ? heartbeats_to_trip_ : kHeartbeatsToConfirm;
  if (attempts_ == 0 || heartbeats_since_attempt_ >= patience) {
    if (attempts_ == config_.bring_up_attempts && heartbeat_.error != 0) {
      phase_ = Phase::kEnded;
      return;
    }
    Arm(out);
  } else if (!proving) {
    CommandTorque(0.0, out);  // feeds the watchdog until a heartbeat confirms
  }
}

void ODriveCanSimple::Arm(FrameList* out) {
  const int node = config_.node_id;
  out->Push(odrive::EncodeClearErrors(node));
  out->Push(
      odrive::EncodeSetControllerMode(node, {odrive::ControlMode::kTorque, odrive::InputMode::kPassthrough}));
  out->Push(odrive::EncodeSetInputTorque(node, 0.0f));  // the drive keeps an old one through a disarm
  out->Push(odrive::EncodeSetAxisState(node, AxisState::kClosedLoop));
  attempts_ = std::min(attempts_ + 1, config_.bring_up_attempts);
  heartbeats_since_attempt_ = 0;
}

void ODriveCanSimple::RequestSample(int64_t now_ns, FrameList* out) {
  if (phase_ == Phase::kTorque && IsSilent(now_ns)) {
    heartbeat_lost_ = true;
    phase_ = Phase::kEnded;
  }
  out->Push(odrive::EncodeEncoderRequest(config_.node_id));
}

bool ODriveCanSimple::IsSilent(int64_t now_ns) const {
  return 1e-9 * static_cast<double>(now_ns - heartbeat_ns_) > config_.odrive.heartbeat_timeout_s;
}

void ODriveCanSimple::CommandTorque(double tau_Nm, FrameList* out) {
  const double limit = config_.torque_limit_Nm;
  const bool follows = phase_ == Phase::kTorque && std::isfinite(tau_Nm);
  const double allowed_Nm = follows ? std::clamp(tau_Nm, -limit, limit) : 0.0;
  const double motor_Nm = config_.direction * allowed_Nm / config_.gear_ratio;
  out->Push(odrive::EncodeSetInputTorque(config_.node_id, FloatTowardZero(motor_Nm)));
}

/// CANSimple has no ramp: the e-stop disarms at once, and latches an error that keeps the axis so.
void ODriveCanSimple::QuickStop(FrameList* out) {
  phase_ = Phase::kEnded;
  out->Push(odrive::EncodeEstop(config_.node_id));
}

void ODriveCanSimple::Disable(FrameList* out) {
  phase_ = Phase::kEnded;
  out->Push(odrive::EncodeSetAxisState(config_.node_id, AxisState::kIdle));
}

Reception ODriveCanSimple::OnFrame(const CanFrame& frame) {
  odrive::Command command{};
  if (!odrive::IsForNode(frame, config_.node_id, &command) || frame.remote) return Reception::kNotMine;
  if (command == odrive::Command::kHeartbeat) {
    odrive::Heartbeat heartbeat;
    if (!odrive::DecodeHeartbeat(frame, config_.node_id, firmware_, &heartbeat)) return Reception::kMalformed;
    OnHeartbeat(heartbeat, frame.stamp_ns);
    return Reception::kTaken;
  }
  if (command != odrive::Command::kEncoderEstimates) return Reception::kNotMine;
  odrive::EncoderEstimates estimates;
  if (!odrive::DecodeEncoderEstimates(frame, config_.node_id, &estimates)) return Reception::kMalformed;
  const double joint_rad_per_turn = config_.direction * 2.0 * std::numbers::pi / config_.gear_ratio;
  sample_.position_rad = joint_rad_per_turn * estimates.position_turns + config_.offset_rad;
  sample_.velocity_rad_s = joint_rad_per_turn * estimates.velocity_turns_s;
  sample_.stamp_ns = frame.stamp_ns;
  ++sample_.sequence;
  return Reception::kTaken;
}

void ODriveCanSimple::OnHeartbeat(const odrive::Heartbeat& heartbeat, int64_t stamp_ns) {
  heartbeat_ = heartbeat;
  heartbeat_ns_ = stamp_ns;
  heard_ = true;
  heartbeats_since_attempt_ = std::min(heartbeats_since_attempt_ + 1, heartbeats_to_trip_);
  if (phase_ == Phase::kBringUp && watchdog_ == DriveWatchdog::kUnproved &&
      (heartbeat.error & odrive::WatchdogError(firmware_)) != 0) {
    watchdog_ = DriveWatchdog::kProved;
    attempts_ = 0;
  }
  const bool torque = heartbeat.state == AxisState::kClosedLoop && heartbeat.error == 0;
  const bool to_stay = watchdog_ == DriveWatchdog::kProved && attempts_ > 0;
  if (phase_ == Phase::kBringUp && to_stay && torque) phase_ = Phase::kTorque;
  if (phase_ == Phase::kTorque && !torque) phase_ = Phase::kEnded;
}

std::vector<CanFilter> ODriveCanSimple::Filters() const {
  // Every message of the node, both ways: what the drive says, and our own as proof that it was sent.
  return {{.id = static_cast<uint32_t>(config_.node_id) << 5, .mask = 0x7E0}};
}

void ODriveCanSimple::Reset() {
  phase_ = Phase::kBringUp;
  watchdog_ = DriveWatchdog::kUnproved;
  attempts_ = 0;
  heartbeat_lost_ = false;
}

DriveState ODriveCanSimple::state() const {
  if (!heard_) return DriveState::kUnknown;
  if (phase_ == Phase::kTorque) return DriveState::kTorque;
  if (watchdog_ == DriveWatchdog::kOff) return DriveState::kFault;
  if (phase_ == Phase::kBringUp) {
    return attempts_ > 0 || watchdog_ == DriveWatchdog::kProved ? DriveState::kEnabling : DriveState::kIdle;
  }
  return heartbeat_.error != 0 ? DriveState::kFault : DriveState::kIdle;
}

std::string ODriveCanSimple::Explain() const {
  if (!heard_) return "no heartbeat heard";
  if (phase_ == Phase::kTorque) return "";
  if (watchdog_ == DriveWatchdog::kOff) {
    return "its watchdog is off: it stayed armed in silence; set axis0.config.enable_watchdog and "
           "watchdog_timeout";
  }
  if (heartbeat_lost_) return "its heartbeat is lost";
  if (heartbeat_.error != 0) return "axis error " + Hexadecimal(heartbeat_.error);
  return watchdog_ == DriveWatchdog::kUnproved ? "has not shown its watchdog yet" : "not in closed loop";
}

}  // namespace armada
