#include "hil/odrive_emulator.h"

#include <algorithm>
#include <limits>

namespace armada {
namespace {

using odrive::AxisState;
using odrive::Command;
using odrive::ControlMode;

/// What the emulated drive says that it is: a Pro with the firmware of the manual that it is made after.
constexpr odrive::Version kVersion = {.protocol = 2, .hardware = {4, 4, 58}, .firmware = {0, 6, 10}};
constexpr double kNever = std::numeric_limits<double>::infinity();
// Axis errors that the drive has by itself.
constexpr uint32_t kMotorFailed = 0x40;      // 0.5
constexpr uint32_t kGateDriverFault = 0x20;  // 0.6

}  // namespace

ODriveEmulator::ODriveEmulator(const JointDriveConfig& joint, const EmulatedDriveConfig& config,
                               uint64_t seed)
    : joint_(joint),
      firmware_(odrive::FirmwareOf(joint.profile)),
      watchdog_s_(config.watchdog_s),
      sensor_(joint, config.encoder_counts_per_turn, config.velocity_noise_rad_s, seed),
      torque_(config.latency_s),
      heartbeat_(joint.odrive.heartbeat_s),
      feedback_(config.feedback_period_s) {}

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
  } else if (command == Command::kGetVersion && firmware_ == odrive::Firmware::kV06) {
    out->Push(odrive::EncodeVersion(joint_.node_id, kVersion));
  }
}

void ODriveEmulator::OnTime(double t_s, const JointTruth& truth, FrameList* out) {
  CheckWatchdog(t_s);
  torque_.Apply(t_s);
  if (heartbeat_.Take(t_s)) SendHeartbeat(out);
  if (feedback_.Take(t_s)) SendEstimates(truth, out);
}

void ODriveEmulator::OnDataFrame(double t_s, Command command, const CanFrame& frame) {
  switch (command) {
    case Command::kEstop:
      error_ |= odrive::EstopError(firmware_);
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
    case Command::kGetVersion:
    case Command::kHeartbeat:
    case Command::kEncoderEstimates:
      return;
  }
  ScheduleTorque(t_s);
}

void ODriveEmulator::CheckWatchdog(double t_s) {
  const double deadline_s = WatchdogDeadline_s();
  if (t_s >= deadline_s) Disarm(odrive::WatchdogError(firmware_));
}

void ODriveEmulator::Fail(double t_s, FrameList* /*out*/) {
  CheckWatchdog(t_s);
  Disarm(firmware_ == odrive::Firmware::kV05 ? kMotorFailed : kGateDriverFault);
}

void ODriveEmulator::Disarm(uint32_t error) {
  error_ |= error;
  state_ = AxisState::kIdle;
  torque_.Cut();
}

double ODriveEmulator::WatchdogDeadline_s() const {
  const bool expired = (error_ & odrive::WatchdogError(firmware_)) != 0;
  return watchdog_s_ > 0.0 && !expired ? last_fed_s_ + watchdog_s_ : kNever;
}

void ODriveEmulator::ScheduleTorque(double t_s) {
  const bool follows = state_ == AxisState::kClosedLoop && mode_.control == ControlMode::kTorque;
  torque_.Schedule(t_s, follows ? JointTorque(joint_, input_torque_Nm_) : 0.0);
}

double ODriveEmulator::Torque(double t_s) const {
  return t_s >= WatchdogDeadline_s() ? 0.0 : torque_.At(t_s);
}

double ODriveEmulator::NextTorqueChange(double t_s) const {
  const double watchdog_s = WatchdogDeadline_s();
  const double next_s = torque_.NextChange(t_s);
  return ProducesTorque() && watchdog_s > t_s ? std::min(next_s, watchdog_s) : next_s;
}

double ODriveEmulator::NextEvent(double t_s) const {
  return std::max(t_s, std::min({heartbeat_.due_s(), feedback_.due_s(), WatchdogDeadline_s()}));
}

void ODriveEmulator::SendHeartbeat(FrameList* out) const {
  constexpr uint8_t kSuccess = 0;
  constexpr uint8_t kBusy = 1;
  constexpr uint8_t kDisarmed = 3;
  const uint8_t result = ProducesTorque() ? kBusy : error_ != 0 ? kDisarmed : kSuccess;
  out->Push(odrive::EncodeHeartbeat(joint_.node_id, firmware_, {error_, state_, result}));
}

void ODriveEmulator::SendEstimates(const JointTruth& truth, FrameList* out) {
  const JointSensor::Reading reading = sensor_.Read(truth);
  out->Push(odrive::EncodeEncoderEstimates(joint_.node_id, {static_cast<float>(reading.position_turns),
                                                            static_cast<float>(reading.velocity_turns_s)}));
}

}  // namespace armada
