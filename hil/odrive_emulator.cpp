#include "hil/odrive_emulator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace armada {
namespace {

using odrive::AxisState;
using odrive::Command;
using odrive::ControlMode;

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kTurn_rad = 2.0 * std::numbers::pi;

/// Standard normal, near enough for noise and the same bits on every machine: the sum of twelve uniform
/// 16-bit numbers has mean 6 (2^16 - 1), variance 2^32 - 1 and no use for a mathematics library. It ends at
/// six standard deviations.
double StandardNormal(std::mt19937_64* random) {
  uint64_t sum = 0;
  for (int word = 0; word < 3; ++word) {
    const uint64_t bits = (*random)();
    sum += (bits & 0xFFFF) + (bits >> 16 & 0xFFFF) + (bits >> 32 & 0xFFFF) + (bits >> 48);
  }
  return (static_cast<double>(sum) - 6.0 * 0xFFFF) / 0x10000;
}

}  // namespace

double ODriveEmulator::Periodic::due_s() const {
  return period_s > 0.0 ? static_cast<double>(next) * period_s : kNever;
}

bool ODriveEmulator::Periodic::Take(double t_s) {
  if (due_s() > t_s) return false;
  next = std::max(next, static_cast<uint64_t>(t_s / period_s));
  while (due_s() <= t_s) ++next;  // once or twice: the quotient above is rounded
  return true;
}

ODriveEmulator::ODriveEmulator(const JointDriveConfig& joint, const EmulatedDriveConfig& config,
                               uint64_t seed)
    : joint_(joint),
      config_(config),
      random_(seed),
      heartbeat_{kHeartbeatPeriod_s, 0},
      feedback_{config.feedback_period_s, 0} {}

void ODriveEmulator::OnFrame(double t_s, const CanFrame& frame, const JointTruth& truth, FrameList* out) {
  Command command{};
  if (!odrive::IsForNode(frame, joint_.node_id, &command)) return;
  CheckWatchdog(t_s);
  last_fed_s_ = t_s;
  if (!frame.remote) {
    OnDataFrame(t_s, command, frame);
  } else if (command == Command::kEncoderEstimates) {
    SendEstimates(truth, out);
  } else if (command == Command::kHeartbeat) {
    SendHeartbeat(out);
  }
}

void ODriveEmulator::OnTime(double t_s, const JointTruth& truth, FrameList* out) {
  CheckWatchdog(t_s);
  ApplyTorqueChanges(t_s);
  if (heartbeat_.Take(t_s)) SendHeartbeat(out);
  if (feedback_.Take(t_s)) SendEstimates(truth, out);
}

void ODriveEmulator::OnDataFrame(double t_s, Command command, const CanFrame& frame) {
  switch (command) {
    case Command::kEstop:
      error_ |= odrive::EstopError(config_.firmware);
      state_ = AxisState::kIdle;
      break;
    case Command::kClearErrors:
      error_ = 0;
      break;
    case Command::kSetAxisState:
      if (AxisState wanted{}; !odrive::DecodeSetAxisState(frame, joint_.node_id, &wanted)) {
        return;
      } else if (wanted == AxisState::kIdle || (wanted == AxisState::kClosedLoop && error_ == 0)) {
        state_ = wanted;
      }
      break;
    case Command::kSetControllerMode:
      if (!odrive::DecodeSetControllerMode(frame, joint_.node_id, &mode_)) return;
      break;
    case Command::kSetInputTorque:
      if (!odrive::DecodeSetInputTorque(frame, joint_.node_id, &input_torque_Nm_)) return;
      break;
    case Command::kHeartbeat:
    case Command::kEncoderEstimates:
      return;
  }
  ScheduleTorque(t_s);
}

void ODriveEmulator::CheckWatchdog(double t_s) {
  const double deadline_s = WatchdogDeadline_s();
  if (t_s < deadline_s) return;
  error_ |= odrive::WatchdogError(config_.firmware);
  state_ = AxisState::kIdle;
  torque_Nm_ = 0.0;
  pending_count_ = 0;
}

double ODriveEmulator::WatchdogDeadline_s() const {
  const bool expired = (error_ & odrive::WatchdogError(config_.firmware)) != 0;
  return config_.watchdog_s > 0.0 && !expired ? last_fed_s_ + config_.watchdog_s : kNever;
}

void ODriveEmulator::ScheduleTorque(double t_s) {
  const bool follows = state_ == AxisState::kClosedLoop && mode_.control == ControlMode::kTorque;
  const double wanted_Nm = follows ? joint_.direction * joint_.gear_ratio * input_torque_Nm_ : 0.0;
  const double tau_Nm = std::clamp(wanted_Nm, -joint_.torque_limit_Nm, joint_.torque_limit_Nm);
  ApplyTorqueChanges(t_s);
  // More commands within one latency than there is room for: the last of them wins.
  if (pending_count_ == pending_.size()) --pending_count_;
  pending_[pending_count_++] = {t_s + config_.latency_s, tau_Nm};
}

void ODriveEmulator::ApplyTorqueChanges(double t_s) {
  size_t applied = 0;
  while (applied < pending_count_ && pending_[applied].t_s <= t_s) torque_Nm_ = pending_[applied++].tau_Nm;
  std::move(pending_.begin() + applied, pending_.begin() + pending_count_, pending_.begin());
  pending_count_ -= applied;
}

double ODriveEmulator::Torque(double t_s) const {
  if (t_s >= WatchdogDeadline_s()) return 0.0;
  double tau_Nm = torque_Nm_;
  for (size_t i = 0; i < pending_count_ && pending_[i].t_s <= t_s; ++i) tau_Nm = pending_[i].tau_Nm;
  return tau_Nm;
}

double ODriveEmulator::NextTorqueChange(double t_s) const {
  const double watchdog_s = WatchdogDeadline_s();
  double next_s = ProducesTorque() && watchdog_s > t_s ? watchdog_s : kNever;
  for (size_t i = 0; i < pending_count_; ++i) {
    if (pending_[i].t_s > t_s) return std::min(next_s, pending_[i].t_s);
  }
  return next_s;
}

double ODriveEmulator::NextEvent(double t_s) const {
  return std::max(t_s, std::min({heartbeat_.due_s(), feedback_.due_s(), WatchdogDeadline_s()}));
}

void ODriveEmulator::SendHeartbeat(FrameList* out) const {
  constexpr uint8_t kSuccess = 0;
  constexpr uint8_t kBusy = 1;
  constexpr uint8_t kDisarmed = 3;
  const uint8_t result = ProducesTorque() ? kBusy : error_ != 0 ? kDisarmed : kSuccess;
  out->Push(odrive::EncodeHeartbeat(joint_.node_id, config_.firmware, {error_, state_, result}));
}

void ODriveEmulator::SendEstimates(const JointTruth& truth, FrameList* out) {
  const double turns_per_rad = joint_.direction * joint_.gear_ratio / kTurn_rad;
  const double counts = config_.encoder_counts_per_turn;
  double position_turns = turns_per_rad * (truth.position_rad - joint_.offset_rad);
  if (counts > 0.0) position_turns = std::floor(position_turns * counts + 0.5) / counts;
  double velocity_rad_s = truth.velocity_rad_s;
  if (config_.velocity_noise_rad_s > 0.0)
    velocity_rad_s += config_.velocity_noise_rad_s * StandardNormal(&random_);
  out->Push(odrive::EncodeEncoderEstimates(
      joint_.node_id,
      {static_cast<float>(position_turns), static_cast<float>(turns_per_rad * velocity_rad_s)}));
}

}  // namespace armada
