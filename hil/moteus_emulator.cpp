#include "hil/moteus_emulator.h"

#include <algorithm>
#include <cmath>

namespace armada {
namespace {

using moteus::Mode;
using moteus::Register;

// Subframe types and errors, mjlib multiplex/format.h.
constexpr uint32_t kWriteBase = 0x00;
constexpr uint32_t kReadBase = 0x10;
constexpr uint32_t kReplyBase = 0x20;
constexpr uint32_t kWriteErrorFrame = 0x30;
constexpr uint32_t kReadErrorFrame = 0x31;
constexpr uint32_t kUnknownRegister = 1;
constexpr uint32_t kNotWriteable = 2;

}  // namespace

MoteusEmulator::MoteusEmulator(const JointDriveConfig& joint, const EmulatedDriveConfig& config,
                               uint64_t seed)
    : joint_(joint),
      sensor_(joint, config.encoder_counts_per_turn, config.velocity_noise_rad_s, seed),
      torque_(config.latency_s) {}

void MoteusEmulator::OnFrame(double t_s, const CanFrame& frame, const JointTruth& truth, FrameList* out) {
  if (frame.remote || frame.error || frame.id > 0xFFFF) return;
  if ((frame.id & 0xFF) != static_cast<uint32_t>(joint_.node_id)) return;
  Update(t_s, truth);
  reading_ = sensor_.Read(truth);
  const int source = static_cast<int>(frame.id >> 8 & 0x7F);
  CanFrame answer = moteus::EmptyFrame(moteus::AnswerId(source, joint_.node_id));
  answer.bitrate_switch = frame.bitrate_switch;
  const bool answered = (frame.id & 0x8000) != 0;
  MoteusWriter writer(&answer);
  MoteusReader reader(frame);
  command_valid_ = false;
  for (std::optional<uint32_t> type = reader.Varuint(); type; type = reader.Varuint()) {
    if (*type == moteus::kNop) continue;
    const bool read = *type >= kReadBase && *type < kReadBase + 16;
    const bool write = *type < kWriteBase + 16;
    if (write && !OnWrite(*type - kWriteBase, &reader, &writer)) break;
    if (read && !OnRead(*type - kReadBase, t_s, &reader, &writer)) break;
    if (!read && !write) break;
  }
  if (answered) {
    answer.fd = frame.fd || answer.length > 8;
    if (answer.fd) moteus::Pad(&answer);
    out->Push(answer);
  }
  if (command_valid_) Execute(t_s);
}

bool MoteusEmulator::OnWrite(unsigned type_and_count, MoteusReader* reader, MoteusWriter* answer) {
  const auto type = static_cast<MoteusType>(type_and_count / 4);
  const std::optional<uint32_t> count = type_and_count % 4 != 0 ? type_and_count % 4 : reader->Varuint();
  const std::optional<uint32_t> first = reader->Varuint();
  if (!count || !first) return false;
  for (uint32_t i = 0; i < *count; ++i) {
    const auto reg = static_cast<Register>(*first + i);
    const std::optional<double> value = reader->Value(type, reg);
    if (!value) return false;
    if (const uint32_t error = Write(reg, *value); error != 0) {
      answer->Varuint(kWriteErrorFrame);
      answer->Varuint(*first + i);
      answer->Varuint(error);
    }
  }
  return true;
}

bool MoteusEmulator::OnRead(unsigned type_and_count, double t_s, MoteusReader* reader, MoteusWriter* answer) {
  const auto type = static_cast<MoteusType>(type_and_count / 4);
  const std::optional<uint32_t> count = type_and_count % 4 != 0 ? type_and_count % 4 : reader->Varuint();
  const std::optional<uint32_t> first = reader->Varuint();
  if (!count || !first) return false;
  const unsigned start = answer->length();
  answer->Varuint(kReplyBase + type_and_count);
  if (type_and_count % 4 == 0) answer->Varuint(*count);
  answer->Varuint(*first);
  for (uint32_t i = 0; i < *count; ++i) {
    const auto reg = static_cast<Register>(*first + i);
    double value = 0.0;
    if (!Read(reg, type, t_s, &value)) {
      answer->Truncate(start);
      answer->Varuint(kReadErrorFrame);
      answer->Varuint(*first + i);
      answer->Varuint(kUnknownRegister);
      return false;
    }
    answer->Value(type, reg, value);
  }
  return true;
}

double MoteusEmulator::Command::*MoteusEmulator::FieldOf(Register reg) {
  switch (reg) {
    case Register::kCommandPosition:
      return &Command::position_turns;
    case Register::kCommandVelocity:
      return &Command::velocity_turns_s;
    case Register::kCommandTorque:
      return &Command::torque_Nm;
    case Register::kCommandKpScale:
      return &Command::kp_scale;
    case Register::kCommandKdScale:
      return &Command::kd_scale;
    case Register::kCommandMaxTorque:
      return &Command::max_torque_Nm;
    case Register::kCommandStopPosition:
      return &Command::stop_position_turns;
    case Register::kCommandTimeout:
      return &Command::timeout_s;
    default:
      return nullptr;
  }
}

uint32_t MoteusEmulator::Write(Register reg, double value) {
  if (reg == Register::kMode) {
    command_ = {};
    const double mode = std::isnan(value) ? 0.0 : std::clamp(value, -128.0, 127.0);  // as ARM converts
    command_.mode = static_cast<Mode>(static_cast<int8_t>(mode));
    command_valid_ = true;
    return 0;
  }
  if (double Command::*const field = FieldOf(reg); field != nullptr) {
    command_.*field = value;
    return 0;
  }
  double unused = 0.0;
  const bool known = Read(reg, MoteusType::kInt32, 0.0, &unused);
  return known ? kNotWriteable : kUnknownRegister;
}

bool MoteusEmulator::Read(Register reg, MoteusType type, double t_s, double* value) const {
  switch (reg) {
    case Register::kMode:
      *value = static_cast<double>(mode_);
      return true;
    case Register::kPosition:
      *value = reading_.position_turns;
      return true;
    case Register::kVelocity:
      *value = reading_.velocity_turns_s;
      return true;
    case Register::kTorque:
      *value = Torque(t_s) / (joint_.direction * joint_.gear_ratio);
      return true;
    case Register::kVoltage:
      *value = kSupply_V;
      return true;
    case Register::kTemperature:
      *value = kTemperature_degC;
      return true;
    case Register::kFault:
      *value = fault_;
      return true;
    case Register::kRegisterMapVersion:
      *value = moteus::kRegisterMap;
      return type == MoteusType::kInt32;
    default:
      break;
  }
  double Command::*const field = FieldOf(reg);
  if (field != nullptr) *value = command_.*field;
  return field != nullptr;
}

void MoteusEmulator::Execute(double t_s) {
  if (command_.mode == Mode::kStopped) {
    fault_ = 0;
    return PowerOff(Mode::kStopped);
  }
  if (command_.mode != Mode::kPosition) return;
  const double timeout_s = command_.timeout_s == 0.0 ? kDefaultTimeout_s : command_.timeout_s;
  deadline_s_ = std::isnan(timeout_s) ? kNever : t_s + std::max(timeout_s, 0.0);
  if (mode_ == Mode::kStopped) {
    mode_ = Mode::kEnabling;
    enabled_at_s_ = t_s + kEnabling_s;
  } else if (mode_ == Mode::kPosition) {
    ScheduleTorque(t_s);
  }
}

void MoteusEmulator::ScheduleTorque(double t_s) {
  const bool torque_only = command_.kp_scale == 0.0 && command_.kd_scale == 0.0;
  const double wanted_Nm = torque_only && std::isfinite(command_.torque_Nm) ? command_.torque_Nm : 0.0;
  const double limit_Nm = std::isnan(command_.max_torque_Nm) ? kNever : std::abs(command_.max_torque_Nm);
  torque_.Schedule(t_s, JointTorque(joint_, std::clamp(wanted_Nm, -limit_Nm, limit_Nm)));
}

void MoteusEmulator::PowerOff(Mode mode) {
  mode_ = mode;
  torque_.Cut();
  damping_Nm_ = 0.0;
  enabled_at_s_ = deadline_s_ = next_damping_s_ = kNever;
}

void MoteusEmulator::Fail(double /*t_s*/, FrameList* /*out*/) {
  constexpr uint8_t kMotorDriverFault = 33;
  Fail(kMotorDriverFault);
}

void MoteusEmulator::Fail(uint8_t fault) {
  fault_ = fault;
  PowerOff(Mode::kFault);
}

void MoteusEmulator::OnTime(double t_s, const JointTruth& truth, FrameList* /*out*/) {
  Update(t_s, truth);
}

void MoteusEmulator::Update(double t_s, const JointTruth& truth) {
  torque_.Apply(t_s);
  if (t_s >= enabled_at_s_) {
    mode_ = Mode::kPosition;
    enabled_at_s_ = kNever;
    ScheduleTorque(t_s);
  }
  if (mode_ == Mode::kPosition && t_s >= deadline_s_) {
    PowerOff(Mode::kPositionTimeout);
    next_damping_s_ = t_s;
  }
  if (t_s >= next_damping_s_) {
    const double wanted_Nm = -kDamping_Nms * sensor_.Read(truth).velocity_turns_s;
    damping_Nm_ = JointTorque(joint_, std::clamp(wanted_Nm, -kTimeoutMaxTorque_Nm, kTimeoutMaxTorque_Nm));
    next_damping_s_ = t_s + kDampingPeriod_s;
  }
}

double MoteusEmulator::Torque(double t_s) const {
  if (mode_ == Mode::kPositionTimeout) return damping_Nm_;
  return mode_ == Mode::kPosition && t_s < deadline_s_ ? torque_.At(t_s) : 0.0;
}

double MoteusEmulator::NextTorqueChange(double t_s) const {
  double next_s = mode_ == Mode::kPosition ? torque_.NextChange(t_s) : kNever;
  for (const double change_s : {enabled_at_s_, deadline_s_, next_damping_s_}) {
    if (change_s > t_s) next_s = std::min(next_s, change_s);
  }
  return next_s;
}

double MoteusEmulator::NextEvent(double t_s) const {
  const double deadline_s = mode_ == Mode::kPosition ? deadline_s_ : kNever;
  return std::max(t_s, std::min({enabled_at_s_, deadline_s, next_damping_s_}));
}

}  // namespace armada
