#include "firmware/can/cia402_drive.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware/can/value_format.h"

namespace armada {

using canopen::NmtCommand;
using canopen::NmtState;
using cia402::PowerState;

namespace {

int64_t Nanoseconds(double time_s) {
  return std::llround(1e9 * time_s);
}

}  // namespace

Cia402Drive::Cia402Drive(const JointDriveConfig& config, bool sync_producer)
    : config_(config),
      sync_producer_(sync_producer),
      heartbeat_ns_(Nanoseconds(config.cia402.heartbeat_s)),
      heartbeat_timeout_ns_(Nanoseconds(config.cia402.heartbeat_timeout_s)),
      boot_timeout_ns_(Nanoseconds(config.cia402.boot_timeout_s)),
      torque_unit_Nm_(cia402::TorqueUnit_Nm(config.cia402, cia402::MaxTorqueOf(config))),
      torque_max_units_(config.cia402.torque_of_max ? 1000
                                                    : std::min<int>(cia402::MaxTorqueOf(config), INT16_MAX)),
      setup_(config) {}

bool Cia402Drive::Prepare(int64_t now_ns, FrameList* out) {
  if (phase_ == Phase::kEnable) {
    controlword_ = cia402::kDisableVoltage;
    SendCommand(0, out);  // the drive watches this frame
  } else if (phase_ != Phase::kTorque) {
    BringUp(now_ns, out);
  }
  return phase_ == Phase::kEnable && heartbeat_seen_;
}

void Cia402Drive::BringUp(int64_t now_ns, FrameList* out) {
  Advance(now_ns, out);
  RequestSample(now_ns, out);  // the drive's status comes on SYNC, and it watches the master's heartbeat
}

void Cia402Drive::Advance(int64_t now_ns, FrameList* out) {
  switch (phase_) {
    case Phase::kBoot:
      return Boot(now_ns, out);
    case Phase::kConfigure:
      return Configure(now_ns, out);
    case Phase::kStart:
      // Without a reply of its own: repeated until the first status, which only an operational drive sends.
      out->Push(canopen::EncodeNmt(NmtCommand::kStart, config_.node_id));
      return;
    case Phase::kEnable:
      return Enable(out);
    case Phase::kTorque:
      return CommandTorque(0.0, out);
    case Phase::kEnded:
      return;
  }
}

/// A reset puts the drive's communication into a known state, whoever used it before.
void Cia402Drive::Boot(int64_t now_ns, FrameList* out) {
  if (reset_sent_ && now_ns - reset_ns_ < boot_timeout_ns_) return;
  out->Push(canopen::EncodeNmt(NmtCommand::kResetCommunication, config_.node_id));
  reset_sent_ = true;
  reset_ns_ = now_ns;
}

void Cia402Drive::Configure(int64_t now_ns, FrameList* out) {
  if (!pre_operational_sent_) {
    // Some drives are set to start by themselves.
    out->Push(canopen::EncodeNmt(NmtCommand::kPreOperational, config_.node_id));
    pre_operational_sent_ = true;
  }
  setup_.Tick(now_ns, out);
  if (setup_.result() == Cia402Setup::Result::kSilent) {
    phase_ = Phase::kBoot;
    reset_sent_ = false;
  }
}

void Cia402Drive::Enable(FrameList* out) {
  switch (power_) {
    case PowerState::kFault:
      if (healthy_ || fault_resets_ == config_.bring_up_attempts) return End("fault");
      controlword_ = controlword_ == cia402::kFaultReset ? cia402::kDisableVoltage : cia402::kFaultReset;
      if (controlword_ == cia402::kFaultReset) ++fault_resets_;
      break;
    case PowerState::kNotReady:
    case PowerState::kFaultReaction:
    case PowerState::kQuickStop:
      controlword_ = cia402::kDisableVoltage;
      break;
    case PowerState::kSwitchOnDisabled:
      controlword_ = cia402::kShutDown;
      break;
    case PowerState::kReady:
      controlword_ = cia402::kSwitchOn;
      break;
    case PowerState::kSwitchedOn:
    case PowerState::kEnabled:
      controlword_ = MayEnable() ? cia402::kEnableOperation : cia402::kSwitchOn;
      break;
  }
  SendCommand(0, out);
}

/// Never in another mode, which might be one that moves, and never a drive whose loss would not be noticed.
bool Cia402Drive::MayEnable() const {
  return status_.mode == cia402::kCyclicSynchronousTorque && heartbeat_seen_;
}

void Cia402Drive::SendCommand(int16_t target_torque, FrameList* out) {
  out->Push(
      cia402::EncodeCommand(config_.node_id, {.controlword = controlword_, .target_torque = target_torque}));
}

void Cia402Drive::RequestSample(int64_t now_ns, FrameList* out) {
  CheckHeartbeat(now_ns);
  if (!sync_producer_) return;
  if (!master_heartbeat_sent_ || now_ns - master_heartbeat_ns_ >= heartbeat_ns_) {
    out->Push(canopen::EncodeHeartbeat(config_.cia402.master_node_id, NmtState::kOperational));
    master_heartbeat_sent_ = true;
    master_heartbeat_ns_ = now_ns;
  }
  out->Push(canopen::EncodeSync());
}

void Cia402Drive::CheckHeartbeat(int64_t now_ns) {
  const bool watched = phase_ == Phase::kEnable || phase_ == Phase::kTorque;
  if (!watched || !heartbeat_seen_ || now_ns - last_heartbeat_ns_ <= heartbeat_timeout_ns_) return;
  End("its heartbeat is lost");
}

void Cia402Drive::CommandTorque(double tau_Nm, FrameList* out) {
  const bool started = phase_ == Phase::kEnable || phase_ == Phase::kTorque || phase_ == Phase::kEnded;
  if (!started || setup_.result() != Cia402Setup::Result::kDone) return;
  if (phase_ != Phase::kTorque || !std::isfinite(tau_Nm) || torque_unit_Nm_ <= 0.0)
    return SendCommand(0, out);
  const double motor_Nm = config_.direction * tau_Nm / config_.gear_ratio;
  // Toward zero: a torque at the limit does not pass it by rounding.
  const double units = std::trunc(motor_Nm / torque_unit_Nm_);
  SendCommand(static_cast<int16_t>(std::clamp<double>(units, -torque_max_units_, torque_max_units_)), out);
}

void Cia402Drive::QuickStop(FrameList* out) {
  End(nullptr);
  SendCommand(0, out);
}

void Cia402Drive::Disable(FrameList* out) {
  End(nullptr);
  controlword_ = cia402::kDisableVoltage;
  SendCommand(0, out);
}

void Cia402Drive::End(const char* fault) {
  if (phase_ != Phase::kEnded || fault_ == nullptr) fault_ = fault;
  phase_ = Phase::kEnded;
  controlword_ = cia402::kQuickStop;  // brakes a drive that is still enabled, and enables none
}

Reception Cia402Drive::OnFrame(const CanFrame& frame) {
  const int node = config_.node_id;
  if (!canopen::IsPlain(frame) || (frame.id & canopen::kNodeMask) != static_cast<uint32_t>(node)) {
    return Reception::kNotMine;
  }
  switch (frame.id & ~canopen::kNodeMask) {
    case canopen::kHeartbeatId: {
      NmtState state{};
      if (!canopen::DecodeHeartbeat(frame, node, &state)) return Reception::kMalformed;
      OnHeartbeat(state, frame.stamp_ns);
      return Reception::kTaken;
    }
    case canopen::kEmergencyId: {
      canopen::Emergency emergency;
      if (!canopen::DecodeEmergency(frame, node, &emergency)) return Reception::kMalformed;
      OnEmergency(emergency);
      return Reception::kTaken;
    }
    case canopen::kSdoReplyId: {
      canopen::Sdo reply;
      if (!canopen::DecodeSdoReply(frame, node, &reply)) return Reception::kMalformed;
      if (phase_ == Phase::kConfigure) setup_.OnReply(reply);
      if (phase_ != Phase::kConfigure) return Reception::kTaken;
      if (setup_.result() == Cia402Setup::Result::kDone) phase_ = Phase::kStart;
      if (setup_.result() == Cia402Setup::Result::kRefused) End("configuration refused");
      return Reception::kTaken;
    }
    case canopen::kTpdo1Id:
    case canopen::kTpdo2Id:
      return OnProcessData(frame);
    default:
      return Reception::kNotMine;
  }
}

Reception Cia402Drive::OnProcessData(const CanFrame& frame) {
  // Mapped as somebody else wanted until this master has configured it.
  if (setup_.result() != Cia402Setup::Result::kDone) return Reception::kNotMine;
  if (cia402::Status status; cia402::DecodeStatus(frame, config_.node_id, &status)) {
    if (PowerState power{}; !cia402::DecodeState(status.statusword, &power)) return Reception::kMalformed;
    OnStatus(status);
    return Reception::kTaken;
  }
  cia402::Motion motion;
  if (!cia402::DecodeMotion(frame, config_.node_id, &motion)) return Reception::kMalformed;
  OnMotion(motion, frame.stamp_ns);
  return Reception::kTaken;
}

void Cia402Drive::OnHeartbeat(NmtState state, int64_t stamp_ns) {
  heard_ = true;
  heartbeat_seen_ = true;
  last_heartbeat_ns_ = stamp_ns;
  if (state == NmtState::kBootUp) return OnBootUp();
  if (phase_ == Phase::kTorque && state != NmtState::kOperational) End("no longer operational");
}

/// In the bring-up whatever was configured is gone: from the start. Later the drive was switched off and on.
void Cia402Drive::OnBootUp() {
  if (phase_ == Phase::kTorque) return End("it has started anew");
  if (phase_ == Phase::kEnded) return;
  phase_ = Phase::kConfigure;
  pre_operational_sent_ = false;
  heartbeat_seen_ = false;
  setup_.Restart();
}

void Cia402Drive::OnEmergency(const canopen::Emergency& emergency) {
  heard_ = true;
  error_code_ = emergency.error_code;
  if (phase_ == Phase::kTorque && emergency.error_code != 0) End("emergency message");
}

void Cia402Drive::OnStatus(const cia402::Status& status) {
  status_ = status;
  cia402::DecodeState(status.statusword, &power_);
  const bool fault = power_ == PowerState::kFault || power_ == PowerState::kFaultReaction;
  const bool torque = power_ == PowerState::kEnabled && status.mode == cia402::kCyclicSynchronousTorque;
  if (phase_ == Phase::kStart) phase_ = Phase::kEnable;
  if (phase_ == Phase::kEnable) {
    healthy_ = healthy_ || !fault;
    // A state that was not asked for in this bring-up does not count.
    if (torque && controlword_ == cia402::kEnableOperation) phase_ = Phase::kTorque;
  } else if (phase_ == Phase::kTorque && !torque) {
    End(fault ? "fault" : "it left operation enabled");
  }
}

void Cia402Drive::OnMotion(const cia402::Motion& motion, int64_t stamp_ns) {
  const double joint_rad_per_turn = config_.direction * 2.0 * std::numbers::pi / config_.gear_ratio;
  sample_.position_rad =
      joint_rad_per_turn * motion.position / config_.cia402.counts_per_turn + config_.offset_rad;
  sample_.velocity_rad_s = joint_rad_per_turn * motion.velocity / config_.cia402.velocity_per_turn_s;
  sample_.stamp_ns = stamp_ns;
  ++sample_.sequence;
}

std::vector<CanFilter> Cia402Drive::Filters() const {
  // Every message of the node, both ways: what the drive says, and our own as proof that it was sent.
  std::vector<CanFilter> filters = {
      {.id = static_cast<uint32_t>(config_.node_id), .mask = canopen::kNodeMask}};
  if (!sync_producer_) return filters;
  const uint32_t heartbeat = canopen::NodeId(canopen::kHeartbeatId, config_.cia402.master_node_id);
  for (const uint32_t id : {canopen::kNmtId, canopen::kSyncId, heartbeat}) {
    filters.push_back({.id = id, .mask = canopen::kCanIdMask});
  }
  return filters;
}

void Cia402Drive::Reset() {
  phase_ = Phase::kBoot;
  reset_sent_ = false;
  setup_.Restart();
  power_ = PowerState::kNotReady;
  healthy_ = false;
  fault_resets_ = 0;
  controlword_ = cia402::kDisableVoltage;
  fault_ = nullptr;
}

DriveState Cia402Drive::state() const {
  if (!heard_) return DriveState::kUnknown;
  switch (phase_) {
    case Phase::kBoot:
      return DriveState::kIdle;
    case Phase::kTorque:
      return DriveState::kTorque;
    case Phase::kEnded:
      return fault_ != nullptr ? DriveState::kFault : DriveState::kIdle;
    case Phase::kConfigure:
    case Phase::kStart:
    case Phase::kEnable:
      break;
  }
  return DriveState::kEnabling;
}

DriveWatchdog Cia402Drive::watchdog() const {
  if (setup_.NoWatchdog()) return DriveWatchdog::kOff;
  return setup_.result() == Cia402Setup::Result::kDone ? DriveWatchdog::kProved : DriveWatchdog::kUnproved;
}

std::string Cia402Drive::Explain() const {
  const std::string code = error_code_ == 0 ? "" : ", error code " + Hexadecimal(error_code_, 4);
  switch (phase_) {
    case Phase::kTorque:
      return "";
    case Phase::kBoot:
      return setup_.result() == Cia402Setup::Result::kSilent ? setup_.Explain() : "no boot-up message heard";
    case Phase::kConfigure:
      return setup_.Explain();
    case Phase::kStart:
      return "no TPDO 1 heard since the NMT start";
    case Phase::kEnded:
      if (setup_.result() == Cia402Setup::Result::kRefused) return setup_.Explain();
      if (fault_ != nullptr) return fault_ + code;
      return "stopped by its master";
    case Phase::kEnable:
      break;
  }
  if (!heartbeat_seen_) return "no heartbeat heard since its configuration";
  return std::string("in state ") + cia402::NameOf(power_) + ", mode " + std::to_string(status_.mode) + code;
}

}  // namespace armada
