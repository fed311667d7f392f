#include "hil/mit_emulator.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

namespace armada {
namespace {

using damiao::Register;
using mit::Special;

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kRadPerTurn = 2.0 * std::numbers::pi;

constexpr uint8_t kDamiaoOverCurrent = 0xA;
constexpr uint8_t kCubeMarsOverCurrent = 2;

uint32_t FloatBits(double value) {
  return std::bit_cast<uint32_t>(static_cast<float>(value));
}

}  // namespace

MitEmulator::MitEmulator(const JointDriveConfig& joint, const EmulatedDriveConfig& config, uint64_t seed)
    : joint_(joint),
      sensor_(joint, config.encoder_counts_per_turn, config.velocity_noise_rad_s, seed),
      torque_(config.latency_s),
      timeout_s_(joint.profile == DriveProfile::kDamiao ? 0.0 : config.watchdog_s) {}

void MitEmulator::OnFrame(double t_s, const CanFrame& frame, const JointTruth& truth, FrameList* out) {
  if (damiao::RegisterAccess request; is_damiao() && damiao::DecodeRequest(frame, joint_, &request)) {
    return OnRegister(request, out);
  }
  if (!mit::IsForDrive(frame, joint_)) return;
  CheckTimeout(t_s);
  torque_.Apply(t_s);
  Special special{};
  const bool is_special =
      mit::DecodeSpecial(frame, &special) && (is_damiao() || special != Special::kClearFault);
  if (!is_special || is_damiao()) {
    last_fed_s_ = t_s;
    timed_out_ = false;
  }
  if (is_special) {
    OnSpecial(t_s, special, truth);
  } else if (control_mode_ == damiao::kMitMode) {
    command_ = mit::DecodeCommand(frame, joint_);
    if (enabled_) ScheduleTorque(t_s);
  }
  SendState(t_s, truth, out);
}

void MitEmulator::OnTime(double t_s, const JointTruth& /*truth*/, FrameList* /*out*/) {
  CheckTimeout(t_s);
  torque_.Apply(t_s);
}

void MitEmulator::OnSpecial(double t_s, Special special, const JointTruth& truth) {
  switch (special) {
    case Special::kEnable:
      if (enabled_ || status_ != 0) return;
      enabled_ = true;
      timed_out_ = false;
      last_fed_s_ = t_s;
      ScheduleTorque(t_s);
      break;
    case Special::kDisable:
      if (enabled_) PowerOff();
      break;
    case Special::kSetZero:
      zero_rad_ += MotorPosition_rad(sensor_.Read(truth));
      break;
    case Special::kClearFault:
      status_ = 0;
      PowerOff();
      break;
  }
}

void MitEmulator::OnRegister(const damiao::RegisterAccess& request, FrameList* out) {
  if (request.access == damiao::Access::kWrite) WriteRegister(request.reg, request.raw);
  bool known = false;
  const uint32_t raw = ReadRegister(request.reg, &known);
  if (known) out->Push(damiao::EncodeAnswer(joint_, {request.access, request.reg, raw}));
}

uint32_t MitEmulator::ReadRegister(Register reg, bool* known) const {
  *known = true;
  switch (reg) {
    case Register::kMasterId:
      return static_cast<uint32_t>(joint_.mit.master_id);
    case Register::kNodeId:
      return static_cast<uint32_t>(joint_.node_id);
    case Register::kTimeout:
      return static_cast<uint32_t>(std::lround(timeout_s_ / damiao::kTimeoutUnit_s));
    case Register::kControlMode:
      return control_mode_;
    case Register::kPositionMax:
      return FloatBits(joint_.mit.position_max_rad);
    case Register::kVelocityMax:
      return FloatBits(joint_.mit.velocity_max_rad_s);
    case Register::kTorqueMax:
      return FloatBits(joint_.mit.torque_max_Nm);
  }
  *known = false;
  return 0;
}

void MitEmulator::WriteRegister(Register reg, uint32_t raw) {
  const double value = std::bit_cast<float>(raw);
  const bool range = std::isfinite(value) && value > 0.0;
  switch (reg) {
    case Register::kTimeout:
      timeout_s_ = damiao::kTimeoutUnit_s * raw;
      break;
    case Register::kControlMode:
      if (raw < 1 || raw > 4) return;
      if (raw != control_mode_) command_ = {};
      control_mode_ = raw;
      break;
    case Register::kPositionMax:
      if (range) joint_.mit.position_max_rad = value;
      break;
    case Register::kVelocityMax:
      if (range) joint_.mit.velocity_max_rad_s = value;
      break;
    case Register::kTorqueMax:
      if (range) joint_.mit.torque_max_Nm = value;
      break;
    case Register::kMasterId:  // addresses of the emulated drive are those of its joint
    case Register::kNodeId:
      break;
  }
}

void MitEmulator::PowerOff() {
  enabled_ = false;
  command_ = {};
  torque_.Cut();
}

void MitEmulator::Fail(double t_s, FrameList* /*out*/) {
  CheckTimeout(t_s);
  if (joint_.profile == DriveProfile::kMiniCheetah) return PowerOff();  // has no word for it
  Fail(is_damiao() ? kDamiaoOverCurrent : kCubeMarsOverCurrent);
}

void MitEmulator::Fail(uint8_t status) {
  status_ = status;
  if (status != 0) PowerOff();
}

double MitEmulator::Deadline_s() const {
  return enabled_ && !timed_out_ && timeout_s_ > 0.0 ? last_fed_s_ + timeout_s_ : kNever;
}

void MitEmulator::CheckTimeout(double t_s) {
  if (t_s < Deadline_s()) return;
  if (is_damiao()) return Fail(damiao::kCommunicationLost);
  timed_out_ = true;
  command_ = {};
  torque_.Cut();
}

void MitEmulator::ScheduleTorque(double t_s) {
  const bool torque_only = command_.kp_Nm_rad == 0.0 && command_.kd_Nms_rad == 0.0;
  torque_.Schedule(t_s, torque_only ? JointTorque(joint_, command_.torque_Nm) : 0.0);
}

double MitEmulator::Torque(double t_s) const {
  return t_s >= Deadline_s() ? 0.0 : torque_.At(t_s);
}

double MitEmulator::NextTorqueChange(double t_s) const {
  const double deadline_s = Deadline_s();
  const double next_s = torque_.NextChange(t_s);
  return deadline_s > t_s ? std::min(next_s, deadline_s) : next_s;
}

double MitEmulator::NextEvent(double t_s) const {
  return std::max(t_s, Deadline_s());
}

double MitEmulator::MotorPosition_rad(const JointSensor::Reading& reading) const {
  return kRadPerTurn * reading.position_turns - zero_rad_;
}

void MitEmulator::SendState(double t_s, const JointTruth& truth, FrameList* out) {
  const JointSensor::Reading reading = sensor_.Read(truth);
  const double motor_Nm = Torque(t_s) / (joint_.direction * joint_.gear_ratio);
  const uint8_t enabled = is_damiao() && enabled_ ? damiao::kEnabled : 0;
  out->Push(mit::EncodeReply(joint_, {MotorPosition_rad(reading), kRadPerTurn * reading.velocity_turns_s,
                                      motor_Nm, status_ != 0 ? status_ : enabled}));
}

}  // namespace armada
