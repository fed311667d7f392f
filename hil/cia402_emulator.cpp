#include "hil/cia402_emulator.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace armada {
namespace {

using cia402::PowerState;

constexpr double kNever = std::numeric_limits<double>::infinity();
/// Error of a drive whose master took it out of operational under power: communication, generic (CiA 402).
constexpr uint16_t kConnectionEnded = 0x8100;
constexpr uint8_t kCommunication = canopen::kGenericError | canopen::kCommunicationError;

// Bits of the statusword beside the state.
constexpr uint16_t kVoltageEnabled = 0x0010;
constexpr uint16_t kRemote = 0x0200;
constexpr uint16_t kInternalLimit = 0x0800;
constexpr uint16_t kFollowsCommand = 0x1000;

}  // namespace

Cia402Emulator::Cia402Emulator(const JointDriveConfig& joint, const EmulatedDriveConfig& config,
                               uint64_t seed)
    : joint_(joint),
      node_(joint),
      sensor_(joint, config.encoder_counts_per_turn, config.velocity_noise_rad_s, seed),
      torque_(config.latency_s) {}

void Cia402Emulator::OnFrame(double t_s, const CanFrame& frame, const JointTruth& truth, FrameList* out) {
  OnTime(t_s, truth, out);
  if (node_.Reads(frame)) Measure(t_s, truth);
  node_.OnFrame(t_s, frame, out);
  React(t_s, out);
}

void Cia402Emulator::OnTime(double t_s, const JointTruth& truth, FrameList* out) {
  torque_.Apply(t_s);
  node_.OnTime(t_s, out);
  if (!node_.Booting()) machine_.Boot();
  React(t_s, out);
  if (braking_ && t_s >= brake_s_) {
    Brake(t_s, truth);
    React(t_s, out);
  }
}

void Cia402Emulator::React(double t_s, FrameList* out) {
  if (node_.TakeReset()) machine_ = {};
  if (const auto loss = node_.TakeLoss()) OnLoss(*loss, out);
  const bool failed = machine_.state() == PowerState::kFault;
  Cia402Dictionary& objects = node_.objects();
  machine_.Control(static_cast<uint16_t>(objects.Raw(cia402::kControlword)),
                   objects.Get(cia402::kQuickStopOption));
  if (failed && machine_.state() != PowerState::kFault) node_.SendEmergency({}, out);
  objects.Set(cia402::kModeDisplay, objects.Get(cia402::kMode));
  if (machine_.Braking() && !braking_) StartBraking(t_s);
  braking_ = machine_.Braking();
  if (machine_.state() == PowerState::kEnabled) {
    Follow(t_s);
  } else {
    torque_.Cut();
    target_Nm_ = 0.0;
  }
}

void Cia402Emulator::OnLoss(uint16_t error_code, FrameList* out) {
  // Values of 6007h.
  constexpr int64_t kNothing = 0;
  constexpr int64_t kFault = 1;
  constexpr int64_t kDisableVoltage = 2;
  constexpr int64_t kQuickStop = 3;
  const int64_t option = machine_.PowerOn() ? node_.objects().Get(cia402::kAbortConnection) : kNothing;
  if (error_code != 0) {
    node_.SendEmergency({error_code, kCommunication}, out);
  } else if (option == kFault) {
    node_.SendEmergency({kConnectionEnded, kCommunication}, out);
  }
  if (option == kFault) machine_.Fail();
  if (option == kDisableVoltage) machine_.DisableVoltage();
  if (option == kQuickStop) machine_.QuickStop();
}

void Cia402Emulator::Fail(double t_s, FrameList* out) {
  constexpr uint16_t kContinuousOverCurrent = 0x2310;
  Fail(t_s, kContinuousOverCurrent, out);
}

void Cia402Emulator::Fail(double t_s, uint16_t error_code, FrameList* out) {
  machine_.Fail();
  node_.SendEmergency({error_code, canopen::kGenericError}, out);
  React(t_s, out);
}

int64_t Cia402Emulator::BrakeOption() const {
  const bool fault = machine_.state() == PowerState::kFaultReaction;
  return node_.objects().Get(fault ? cia402::kFaultReactionOption : cia402::kQuickStopOption);
}

void Cia402Emulator::StartBraking(double t_s) {
  brake_start_s_ = brake_s_ = t_s;
  brake_Nm_ = 0.0;
  if (BrakeOption() == 0) machine_.Rest(0);
}

void Cia402Emulator::Brake(double t_s, const JointTruth& truth) {
  const double speed_rad_s = std::abs(truth.velocity_rad_s);
  if (speed_rad_s <= kRest_rad_s || t_s >= brake_start_s_ + kMaxBraking_s) {
    return machine_.Rest(node_.objects().Get(cia402::kQuickStopOption));
  }
  const double full_Nm = std::abs(ToJoint_Nm(TorqueLimit_units()));
  const double share = std::min(1.0, speed_rad_s / kFullBraking_rad_s);
  brake_Nm_ = -std::copysign(full_Nm * share, truth.velocity_rad_s);
  brake_s_ = t_s + kBrakePeriod_s;
}

/// The torque that now belongs to the target takes over one latency after `t_s`.
void Cia402Emulator::Follow(double t_s) {
  const Cia402Dictionary& objects = node_.objects();
  const bool torque_mode = objects.Get(cia402::kModeDisplay) == cia402::kCyclicSynchronousTorque;
  const double limit = TorqueLimit_units();
  const auto target = static_cast<double>(torque_mode ? objects.Get(cia402::kTargetTorque) : 0);
  const double target_Nm = ToJoint_Nm(std::clamp(target, -limit, limit));
  if (target_Nm == target_Nm_) return;
  target_Nm_ = target_Nm;
  torque_.Schedule(t_s, target_Nm);
}

double Cia402Emulator::TorqueUnit_Nm() const {
  return cia402::TorqueUnit_Nm(joint_.cia402, static_cast<uint16_t>(node_.objects().Raw(cia402::kMaxTorque)));
}

double Cia402Emulator::TorqueLimit_units() const {
  constexpr double kAllOfMax = 1000.0;
  return joint_.cia402.torque_of_max ? kAllOfMax : node_.objects().Raw(cia402::kMaxTorque);
}

double Cia402Emulator::ToJoint_Nm(double units) const {
  return JointTorque(joint_, units * TorqueUnit_Nm());
}

void Cia402Emulator::Measure(double t_s, const JointTruth& truth) {
  Cia402Dictionary& objects = node_.objects();
  const JointSensor::Reading reading = sensor_.Read(truth);
  objects.Set(cia402::kPosition, std::llround(reading.position_turns * joint_.cia402.counts_per_turn));
  objects.Set(cia402::kVelocity, std::llround(reading.velocity_turns_s * joint_.cia402.velocity_per_turn_s));
  const double unit_Nm = joint_.direction * joint_.gear_ratio * TorqueUnit_Nm();
  objects.Set(cia402::kTorque, unit_Nm != 0.0 ? std::llround(Torque(t_s) / unit_Nm) : 0);
  uint16_t status = machine_.StatusBits() | kVoltageEnabled;
  if (node_.Operational()) status |= kRemote;
  if (machine_.state() == PowerState::kEnabled) {
    status |= kFollowsCommand;
    const int64_t target = objects.Get(cia402::kTargetTorque);
    if (static_cast<double>(std::abs(target)) > TorqueLimit_units()) status |= kInternalLimit;
  }
  objects.Set(cia402::kStatusword, status);
}

double Cia402Emulator::Torque(double t_s) const {
  if (!machine_.PowerOn()) return 0.0;
  if (machine_.state() != PowerState::kEnabled) return braking_ ? brake_Nm_ : 0.0;
  const bool lost = t_s >= node_.Deadline() && node_.objects().Get(cia402::kAbortConnection) != 0;
  return lost ? 0.0 : torque_.At(t_s);
}

double Cia402Emulator::NextTorqueChange(double t_s) const {
  if (!machine_.PowerOn()) return kNever;
  double next_s = torque_.NextChange(t_s);
  if (node_.Deadline() > t_s) next_s = std::min(next_s, node_.Deadline());
  if (braking_ && brake_s_ > t_s) next_s = std::min(next_s, brake_s_);
  return next_s;
}

double Cia402Emulator::NextEvent(double t_s) const {
  return std::max(t_s, std::min(node_.NextEvent(), braking_ ? brake_s_ : kNever));
}

}  // namespace armada
