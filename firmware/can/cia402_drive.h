#pragma once

#include "firmware/can/cia402_messages.h"
#include "firmware/can/cia402_setup.h"
#include "firmware/can/joint_drive.h"

namespace armada {

/// Master's side of one CiA 402 drive in cyclic synchronous torque over CANopen.
///   q = direction 2 pi position / (counts_per_turn gear_ratio) + offset,  tau = direction gear_ratio
///   tau_motor.
///
/// Bring-up: reset communication, boot-up message, configuration by SDO (Cia402Setup), NMT start, then the
/// controlwords up to operation enabled with mode 10 on display. An old fault is reset on the way; a new one
/// is not. The watchdog is the drive's timeout on RPDO 1, written and read back.
///
/// On the bus: RPDO 1 with every torque, at once in force; SYNC with every sample request, answered with TPDO
/// 1 (status) and TPDO 2 (position and velocity, one sample).
class Cia402Drive final : public JointDrive {
 public:
  /// `sync_producer`: this drive also sends what its bus needs once, SYNC and the master's heartbeat.
  Cia402Drive(const JointDriveConfig& config, bool sync_producer);

  bool Prepare(int64_t now_ns, FrameList* out) override;
  void BringUp(int64_t now_ns, FrameList* out) override;
  void RequestSample(int64_t now_ns, FrameList* out) override;
  /// Before the NMT start nothing; out of torque mode the controlword that stands, with zero torque.
  void CommandTorque(double tau_Nm, FrameList* out) override;
  void QuickStop(FrameList* out) override;
  void Disable(FrameList* out) override;
  Reception OnFrame(const CanFrame& frame) override;
  std::vector<CanFilter> Filters() const override;
  void Reset() override;

  DriveState state() const override;
  DriveWatchdog watchdog() const override;
  uint32_t error_code() const override { return error_code_; }
  const JointSample& sample() const override { return sample_; }
  std::string Explain() const override;

  /// Resets of an old fault that may fail before it is held to be a new one.

 private:
  enum class Phase {
    kBoot,       ///< to be reset, boot-up message not heard since
    kConfigure,  ///< pre-operational
    kStart,      ///< NMT start sent, no status heard since
    kEnable,     ///< runs through the states of the drive
    kTorque,     ///< operation enabled, seen
    kEnded,      ///< left, stopped, refused or given up: no torque until Reset()
  };

  /// One tick of the bring-up's phase.
  void Advance(int64_t now_ns, FrameList* out);
  void Boot(int64_t now_ns, FrameList* out);
  void Configure(int64_t now_ns, FrameList* out);
  void Enable(FrameList* out);
  bool MayEnable() const;
  void SendCommand(int16_t target_torque, FrameList* out);
  void CheckHeartbeat(int64_t now_ns);
  void OnBootUp();
  void OnHeartbeat(canopen::NmtState state, int64_t stamp_ns);
  void OnEmergency(const canopen::Emergency& emergency);
  void OnStatus(const cia402::Status& status);
  void OnMotion(const cia402::Motion& motion, int64_t stamp_ns);
  Reception OnProcessData(const CanFrame& frame);
  /// Out of torque mode, or given up, by what the drive did; null when it just left.
  void End(const char* fault);

  JointDriveConfig config_;
  bool sync_producer_;
  int64_t heartbeat_ns_;
  int64_t heartbeat_timeout_ns_;
  int64_t boot_timeout_ns_;
  double torque_unit_Nm_;  ///< motor side, of 6071h
  int torque_max_units_;   ///< highest 6071h to send
  Cia402Setup setup_;

  Phase phase_ = Phase::kBoot;
  bool heard_ = false;
  bool reset_sent_ = false;  ///< in this bring-up
  int64_t reset_ns_ = 0;
  bool pre_operational_sent_ = false;
  cia402::Status status_;
  cia402::PowerState power_ = cia402::PowerState::kNotReady;
  bool healthy_ = false;  ///< seen without a fault in this bring-up
  int fault_resets_ = 0;
  uint16_t controlword_ = cia402::kDisableVoltage;
  const char* fault_ = nullptr;  ///< why it ended, when that is a fault
  uint32_t error_code_ = 0;
  bool heartbeat_seen_ = false;  ///< since the configuration
  int64_t last_heartbeat_ns_ = 0;
  bool master_heartbeat_sent_ = false;
  int64_t master_heartbeat_ns_ = 0;
  JointSample sample_;
};

}  // namespace armada
