#include "firmware/can/mit_drive.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "firmware/can/value_format.h"

namespace armada {
namespace {

using mit::Special;

/// The first of them may answer a frame of the phase before.
constexpr int kRepliesToConfirm = 2;
/// A joint does not cross half the packed range between two samples: such a step is a position that has run
/// out of its range at one end and on at the other.
constexpr int kLongestStep = 0x8000;

std::string WiringError(const JointDriveConfig& config) {
  char text[160];
  const double limit_Nm = config.torque_limit_Nm / config.gear_ratio;
  const double half_step_Nm = mit::TorqueStep_Nm(config.mit) / 2.0;
  if (limit_Nm < half_step_Nm) {
    std::snprintf(text, sizeof text,
                  "torque_limit_Nm is %g N m at the motor, below half a step (%g N m) of torque_max_Nm",
                  limit_Nm, half_step_Nm);
    return text;
  }
  if (config.mit.master_id == config.node_id) {
    return "master_id and node_id are both " + std::to_string(config.node_id) + ": they must differ";
  }
  if (config.profile == DriveProfile::kDamiao && config.node_id > mit::kMaxDamiaoNode) {
    return "node_id is " + std::to_string(config.node_id) + ", a Damiao reply can tell 0 to 15";
  }
  return "";
}

const char* CubeMarsError(uint32_t code) {
  constexpr const char* kNames[] = {"none",
                                    "motor over temperature",
                                    "over current",
                                    "over voltage",
                                    "under voltage",
                                    "encoder",
                                    "over temperature of the power stage",
                                    "motor stalled"};
  return code < std::size(kNames) ? kNames[code] : "unknown";
}

}  // namespace

MitDrive::MitDrive(const JointDriveConfig& config)
    : config_(config), wiring_error_(WiringError(config)), setup_(config) {}

bool MitDrive::Prepare(int64_t now_ns, FrameList* out) {
  if (phase_ != Phase::kReady) BringUp(now_ns, out);
  return phase_ == Phase::kReady;
}

void MitDrive::BringUp(int64_t now_ns, FrameList* out) {
  if (phase_ == Phase::kEnded) return;
  if (!wiring_error_.empty()) {
    refused_ = true;
    return Enter(Phase::kEnded);
  }
  if (phase_ == Phase::kIdle) Enter(Phase::kDisable);
  if (phase_ == Phase::kReady) Enter(Phase::kEnable);
  // An attempt takes as many ticks as the replies that confirm it.
  if (faulty() && phase_ != Phase::kTorque && ++faults_ > kRepliesToConfirm * config_.bring_up_attempts) {
    refused_ = true;
    return Enter(Phase::kEnded);
  }
  switch (phase_) {
    case Phase::kDisable:
      out->Push(mit::EncodeSpecial(config_, Special::kDisable));
      if (is_damiao() && faulty()) out->Push(mit::EncodeSpecial(config_, Special::kClearFault));
      break;
    case Phase::kSetup:
      setup_.Step(out);
      return;  // not answered with a state
    case Phase::kZero:
    case Phase::kTorque:
      PushTorque(mit::kZeroTorqueCode, out);
      break;
    case Phase::kEnable:
      out->Push(mit::EncodeSpecial(config_, Special::kEnable));
      break;
    case Phase::kIdle:
    case Phase::kReady:
    case Phase::kEnded:
      return;
  }
  asked_ns_ = now_ns;
}

void MitDrive::RequestSample(int64_t now_ns, FrameList* out) {
  if (asked_ns_ != now_ns) PushTorque(torque_code_, out);
}

void MitDrive::CommandTorque(double tau_Nm, FrameList* out) {
  if (phase_ != Phase::kTorque || !std::isfinite(tau_Nm)) return PushTorque(mit::kZeroTorqueCode, out);
  const double motor_Nm = config_.direction * tau_Nm / config_.gear_ratio;
  PushTorque(mit::TorqueCode(config_.mit, motor_Nm, config_.torque_limit_Nm / config_.gear_ratio), out);
}

void MitDrive::PushTorque(uint32_t code, FrameList* out) {
  torque_code_ = code;
  out->Push(mit::EncodeTorque(config_, code));
}

/// At once without torque. The protocol could damp (kd, velocity 0), but only for as long as somebody sends,
/// with a torque that is not limited to ours, and it would take one more frame to end it.
void MitDrive::QuickStop(FrameList* out) {
  Disable(out);
}

void MitDrive::Disable(FrameList* out) {
  Enter(Phase::kEnded);
  PushTorque(mit::kZeroTorqueCode, out);  // mini-cheetah leaves motor mode only when its current is small
  out->Push(mit::EncodeSpecial(config_, Special::kDisable));
}

Reception MitDrive::OnFrame(const CanFrame& frame) {
  if (!mit::IsFromDrive(frame, config_)) return Reception::kNotMine;
  if (damiao::RegisterAccess answer; is_damiao() && damiao::DecodeAnswer(frame, config_, &answer)) {
    heard_ = true;
    if (phase_ == Phase::kSetup) {
      setup_.OnAnswer(answer);
      Advance();
    }
    return Reception::kTaken;
  }
  mit::Reply reply;
  if (!mit::DecodeReply(frame, config_, &reply)) return Reception::kMalformed;
  const uint32_t code = mit::PositionCode(frame);
  const bool at_end = code < mit::kPositionMargin || code > 0xFFFF - mit::kPositionMargin;
  const bool leapt =
      position_code_ && std::abs(static_cast<int>(code) - static_cast<int>(*position_code_)) > kLongestStep;
  if (at_end || leapt) return Reception::kMalformed;
  position_code_ = code;
  OnReply(reply, frame);
  return Reception::kTaken;
}

void MitDrive::OnReply(const mit::Reply& reply, const CanFrame& frame) {
  heard_ = true;
  status_ = reply.status;
  sample_.position_rad = config_.direction * reply.position_rad / config_.gear_ratio + config_.offset_rad;
  sample_.velocity_rad_s = config_.direction * reply.velocity_rad_s / config_.gear_ratio;
  sample_.stamp_ns = frame.stamp_ns;
  ++sample_.sequence;
  replies_ = std::min(replies_ + 1, kRepliesToConfirm);
  Advance();
}

void MitDrive::Advance() {
  const bool confirmed = replies_ >= kRepliesToConfirm && !faulty();
  switch (phase_) {
    case Phase::kDisable:
      if (!confirmed || status_ != damiao::kDisabled) break;
      setup_ = DamiaoSetup(config_);  // anew after a fault, too: the drive may have been switched off and on
      Enter(is_damiao() ? Phase::kSetup : Phase::kZero);
      break;
    case Phase::kSetup:
      if (setup_.done()) Enter(Phase::kZero);
      if (setup_.refused()) {
        refused_ = true;
        Enter(Phase::kEnded);
      }
      break;
    case Phase::kZero:
      if (faulty()) {
        Enter(Phase::kDisable);
      } else if (confirmed) {
        Enter(Phase::kReady);
      }
      break;
    case Phase::kReady:
      if (faulty()) Enter(Phase::kDisable);
      break;
    case Phase::kEnable:
      if (faulty()) {
        Enter(Phase::kDisable);
      } else if (is_damiao() ? status_ == damiao::kEnabled : confirmed) {
        Enter(Phase::kTorque);
      }
      break;
    case Phase::kTorque:
      if (faulty() || (is_damiao() && status_ != damiao::kEnabled)) {
        refused_ = faulty();
        Enter(Phase::kEnded);
      }
      break;
    case Phase::kIdle:
    case Phase::kEnded:
      break;
  }
}

void MitDrive::Enter(Phase phase) {
  phase_ = phase;
  replies_ = 0;
  if (phase != Phase::kTorque) torque_code_ = mit::kZeroTorqueCode;
}

std::vector<CanFilter> MitDrive::Filters() const {
  const auto id = [](int value) { return CanFilter{.id = static_cast<uint32_t>(value), .mask = 0x7FF}; };
  std::vector<CanFilter> filters = {id(config_.node_id), id(config_.mit.master_id)};
  if (is_damiao()) filters.push_back(id(0x7FF));
  return filters;
}

void MitDrive::Reset() {
  Enter(Phase::kIdle);
  setup_ = DamiaoSetup(config_);
  faults_ = 0;
  refused_ = false;
  position_code_.reset();
}

DriveState MitDrive::state() const {
  if (refused_) return DriveState::kFault;
  if (!heard_) return DriveState::kUnknown;
  if (phase_ == Phase::kTorque) return DriveState::kTorque;
  return phase_ == Phase::kIdle || phase_ == Phase::kEnded ? DriveState::kIdle : DriveState::kEnabling;
}

DriveWatchdog MitDrive::watchdog() const {
  return is_damiao() && setup_.done() ? DriveWatchdog::kProved : DriveWatchdog::kUnproved;
}

uint32_t MitDrive::error_code() const {
  return is_damiao() && status_ == damiao::kEnabled ? 0 : status_;
}

std::string MitDrive::Explain() const {
  if (!wiring_error_.empty()) return wiring_error_;
  if (!heard_) {
    return "no answer on identifier " + Hexadecimal(static_cast<uint32_t>(config_.mit.master_id), 3) +
           " with node " + std::to_string(config_.node_id) + " in it";
  }
  if (phase_ == Phase::kTorque) return "";
  if (faulty()) {
    return std::string(is_damiao() ? damiao::StatusName(status_) : CubeMarsError(status_)) + " (" +
           (is_damiao() ? "status " : "error ") + Hexadecimal(status_) + ")";
  }
  if (phase_ == Phase::kSetup || setup_.refused()) return setup_.Explain();
  return phase_ == Phase::kEnded ? "switched off" : "not enabled yet";
}

}  // namespace armada
