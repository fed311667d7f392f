#include "tests/fuzz/drive_world.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "tests/fuzz/require.h"

namespace armada {
namespace {

constexpr double kPeriod_s = 0.01;
constexpr double kFrame_s = 0.0002;
constexpr int kMaxBringUpTicks = 400;
constexpr size_t kRemembered = 64;
/// Events of a drive in the longest time that passes at once, some a millisecond, with room.
constexpr int kMaxEvents = 20000;
/// Of one joint, so that those of an arm with seven joints fit in a FrameList.
constexpr size_t kMaxFramesATick = FrameList::kCapacity / 7;
/// The conversion from motor to joint side rounds.
constexpr double kRounding = 1e-12;

/// Shortens the frame to a length that its kind has, and takes away flags that do not go together.
void MakeValid(CanFrame* frame) {
  frame->id &= frame->extended ? 0x1FFF'FFFFu : 0x7FFu;
  if (frame->fd) {
    frame->remote = false;
    frame->length = std::min<uint8_t>(frame->length, 64);
  } else {
    frame->bitrate_switch = frame->error_state_indicator = false;
    frame->error = frame->error && !frame->remote;
    frame->length = std::min<uint8_t>(frame->length, 8);
  }
  while (!IsValid(*frame)) --frame->length;
}

bool Fits(const CanMessage& message, const CanFrame& frame) {
  if (message.from_drive || message.id != frame.id || message.length != frame.length || frame.remote) {
    return false;
  }
  return message.multiplexor < 0 ||
         GetRaw(frame, message.signals[static_cast<size_t>(message.multiplexor)]) == message.multiplexor_raw;
}

/// The torque in a frame to the drive, or null.
const CanSignal* TorqueIn(const std::vector<CanMessage>& messages, const CanFrame& frame) {
  const auto message = std::find_if(messages.begin(), messages.end(),
                                    [&](const CanMessage& candidate) { return Fits(candidate, frame); });
  if (message == messages.end()) return nullptr;
  const auto torque =
      std::find_if(message->signals.begin(), message->signals.end(),
                   [](const CanSignal& signal) { return std::strcmp(signal.unit, "N m") == 0; });
  return torque == message->signals.end() ? nullptr : &*torque;
}

}  // namespace

DriveWorld::DriveWorld(const DriveSetup& setup)
    : joint_(setup.joint),
      drive_config_(setup.drive),
      messages_(MessagesOf(setup.joint)),
      master_(std::move(MakeDrives(std::span(&setup.joint, 1)).front())),
      drive_(MakeEmulatedDrive(setup.joint, setup.drive, 1)) {}

void DriveWorld::Act(DriveAction action, ByteSource* input) {
  switch (action) {
    case DriveAction::kMessage:
      Inject(ReadMessage(input));
      break;
    case DriveAction::kFrame: {
      CanFrame frame;
      const uint8_t flags = input->Byte();
      frame.extended = (flags & 1) != 0;
      frame.remote = (flags & 2) != 0;
      frame.error = (flags & 4) != 0;
      frame.fd = (flags & 8) != 0;
      frame.bitrate_switch = (flags & 16) != 0;
      frame.error_state_indicator = (flags & 32) != 0;
      frame.id = static_cast<uint32_t>(input->Unsigned(4));
      frame.length = input->Byte();
      MakeValid(&frame);
      input->Take(std::span(frame.data).first(frame.length));
      Inject(frame);
      break;
    }
    case DriveAction::kReplay:
      if (!from_drive_.empty()) Inject(ReadReplay(input));
      break;
    case DriveAction::kBringUp:
      for (int ticks = input->Byte() % 16; ticks >= 0; --ticks) BringUpTick();
      break;
    case DriveAction::kTorque:
      TorqueTick(ReadTorque(input));
      break;
    case DriveAction::kQuickStop:
      Master([&](FrameList* out) { master_->QuickStop(out); });
      ended_ = true;
      break;
    case DriveAction::kDisable:
      Master([&](FrameList* out) { master_->Disable(out); });
      ended_ = true;
      break;
    case DriveAction::kReset:
      master_->Reset();
      was_in_torque_ = ended_ = false;
      break;
    case DriveAction::kTime: {
      const int value = input->Byte();
      Pass(1e-5 * value * value);
      break;
    }
    case DriveAction::kMove:
      truth_.position_rad = 0.01 * input->Signed16();
      truth_.velocity_rad_s = 0.1 * input->Signed16();
      break;
    case DriveAction::kLose:
      to_lose_ = input->Byte();
      break;
    case DriveAction::kPowerCycle:
      PowerCycle();
      break;
    case DriveAction::kRecover:
      Recover();
      break;
  }
  CheckMaster();
  const bool torque_mode = master_->state() == DriveState::kTorque;
  Require(master_->Explain().empty() == torque_mode, "there is a reason for not being in torque mode");
  CheckDrive();
}

CanFrame DriveWorld::ReadMessage(ByteSource* input) const {
  const CanMessage& message = messages_[input->Byte() % messages_.size()];
  const uint8_t length = input->Byte();
  CanFrame frame;
  frame.id = message.id;
  frame.extended = message.extended;
  frame.fd = frame.bitrate_switch = message.fd;
  frame.length = length == 0 ? message.length : length;
  MakeValid(&frame);
  input->Take(std::span(frame.data).first(frame.length));
  return frame;
}

CanFrame DriveWorld::ReadReplay(ByteSource* input) const {
  const size_t back = input->Byte() % from_drive_.size();
  CanFrame frame = from_drive_[from_drive_.size() - 1 - back];
  const size_t at = input->Byte() % frame.data.size();
  frame.data[at] ^= input->Byte();
  return frame;
}

/// A byte: in 1/32 of the torque limit, up to twice that; from 128 on eight bytes follow, any double.
double DriveWorld::ReadTorque(ByteSource* input) const {
  const int choice = input->Byte();
  if (choice >= 128) return input->Double();
  return joint_.torque_limit_Nm * (choice - 64) / 32.0;
}

void DriveWorld::BringUpTick() {
  const double end_s = t_s_ + kPeriod_s;
  const int64_t tick_ns = now_ns();
  const size_t count = Master([&](FrameList* out) { master_->BringUp(tick_ns, out); });
  Require(count <= kMaxFramesATick, "frames of a bring-up tick of seven joints fit in a FrameList");
  Pass(end_s - t_s_);
}

void DriveWorld::TorqueTick(double tau_Nm) {
  const double end_s = t_s_ + kPeriod_s;
  const int64_t tick_ns = now_ns();
  size_t count = Master([&](FrameList* out) { master_->RequestSample(tick_ns, out); });
  count += Master([&](FrameList* out) {
    master_->CommandTorque(tau_Nm, out);
    for (const CanFrame& frame : *out) Require(frame.latest_only, "a commanded torque is latest_only");
  });
  Require(count <= kMaxFramesATick, "frames of a tick of seven joints fit in a FrameList");
  Pass(end_s - t_s_);
}

void DriveWorld::Recover() {
  PowerCycle();
  truth_ = {};
  to_lose_ = 0;
  master_->Reset();
  was_in_torque_ = ended_ = false;
  for (int tick = 0; tick < kMaxBringUpTicks && master_->state() != DriveState::kTorque; ++tick) {
    BringUpTick();
  }
  Require(master_->state() == DriveState::kTorque, "after Reset a healthy drive comes into torque mode");
  Require(drive_->ProducesTorque(), "in torque mode the drive's power is on");
}

void DriveWorld::PowerCycle() {
  drive_ = MakeEmulatedDrive(joint_, drive_config_, 1);
  power_up_ns_ = now_ns();
  t_s_ = 0.0;
  if (!ended_) return;
  // The new drive hears nobody but this master, which must not arm it.
  for (int tick = 0; tick < 5; ++tick) {
    BringUpTick();
    TorqueTick(joint_.torque_limit_Nm);
    Require(!drive_->ProducesTorque(), "a master that has ended arms no drive");
  }
}

template <class Call>
size_t DriveWorld::Master(Call call) {
  const bool torque_mode = master_->state() == DriveState::kTorque;
  FrameList out;
  call(&out);
  for (const CanFrame& frame : out) CheckFromMaster(frame, torque_mode);
  for (const CanFrame& frame : out) {
    Pass(kFrame_s);
    if (!Lost()) ToDrive(frame);
  }
  return out.size();
}

void DriveWorld::CheckFromMaster(const CanFrame& frame, bool torque_mode) const {
  Require(IsValid(frame), "the master sends valid frames");
  const CanSignal* signal = TorqueIn(messages_, frame);
  if (signal == nullptr) return;
  const double motor_Nm = GetPhysical(frame, *signal);
  Require(std::isfinite(motor_Nm), "the master sends finite torques");
  Require(std::abs(motor_Nm * joint_.gear_ratio) <= joint_.torque_limit_Nm * (1.0 + kRounding),
          "the master sends no torque beyond the limit");
  // Packed torques have no code for 0: the nearest is half a step off.
  const double zero_Nm =
      signal->kind == CanSignal::Kind::kFloat32 ? 0.0 : 0.5 * signal->scale * (1.0 + kRounding);
  Require(torque_mode || std::abs(motor_Nm) <= zero_Nm, "out of torque mode the master sends torques of 0");
}

void DriveWorld::Inject(CanFrame frame) {
  Pass(kFrame_s);
  if (Lost()) return;
  ToMaster(frame);
  ToDrive(frame);
}

void DriveWorld::ToDrive(const CanFrame& frame) {
  FrameList answers;
  drive_->OnFrame(t_s_, frame, truth_, &answers);
  Deliver(answers);
}

void DriveWorld::Deliver(const FrameList& answers) {
  Require(answers.size() < FrameList::kCapacity, "no answer of the drive is dropped");
  for (const CanFrame& frame : answers) {
    Require(IsValid(frame), "the drive sends valid frames");
    if (from_drive_.size() == kRemembered) from_drive_.erase(from_drive_.begin());
    from_drive_.push_back(frame);
    if (!Lost()) ToMaster(frame);
  }
}

void DriveWorld::ToMaster(CanFrame frame) {
  frame.stamp_ns = now_ns();
  const Reception reception = master_->OnFrame(frame);
  const JointSample& sample = master_->sample();
  Require(sample.sequence <= samples_ + 1, "one frame gives at most one sample");
  Require(sample.sequence == samples_ || reception == Reception::kTaken, "a sample comes of a taken frame");
  Require(sample.sequence == samples_ || sample.stamp_ns == frame.stamp_ns, "a sample has its frame's time");
  samples_ = sample.sequence;
  CheckMaster();
}

bool DriveWorld::Lost() {
  const bool lost = (to_lose_ & 1) != 0;
  to_lose_ = static_cast<uint8_t>(to_lose_ >> 1);
  return lost;
}

void DriveWorld::Pass(double dt_s) {
  const double end_s = t_s_ + std::max(dt_s, 0.0);
  int events = 0;
  for (double next_s = drive_->NextEvent(t_s_); next_s <= end_s; next_s = drive_->NextEvent(t_s_)) {
    Require(next_s >= t_s_, "no event of the drive lies in the past");
    Require(++events < kMaxEvents, "an event of the drive that was served is over");
    t_s_ = next_s;
    FrameList answers;
    drive_->OnTime(t_s_, truth_, &answers);
    Deliver(answers);
  }
  t_s_ = end_s;
}

void DriveWorld::CheckMaster() {
  const JointSample& sample = master_->sample();
  Require(std::isfinite(sample.position_rad) && std::isfinite(sample.velocity_rad_s), "samples are finite");
  const DriveState state = master_->state();
  if (state == DriveState::kTorque) {
    Require(!ended_, "after torque mode or a stop, torque mode comes back by Reset only");
    Require(master_->watchdog() != DriveWatchdog::kOff, "no torque mode without a watchdog");
  }
  Require(!ended_ || state != DriveState::kEnabling, "after torque mode or a stop nothing is enabled");
  if (was_in_torque_ && state != DriveState::kTorque) ended_ = true;
  was_in_torque_ = state == DriveState::kTorque;
}

void DriveWorld::CheckDrive() const {
  const double torque_Nm = drive_->Torque(t_s_);
  Require(std::isfinite(torque_Nm), "the drive's torque is finite");
  Require(std::abs(torque_Nm) <= joint_.torque_limit_Nm, "the drive's torque is within its limit");
  Require(drive_->NextTorqueChange(t_s_) > t_s_, "the next change of torque is to come");
}

int64_t DriveWorld::now_ns() const {
  return power_up_ns_ + std::llround(1e9 * t_s_);
}

}  // namespace armada
