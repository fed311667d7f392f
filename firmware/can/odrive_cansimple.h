#pragma once

#include "firmware/can/joint_drive.h"
#include "firmware/can/odrive_messages.h"

namespace armada {

/// Master's side of one ODrive axis in torque control over CANSimple.
///
/// The bring-up runs on the drive's heartbeats, ten a second. CANSimple cannot tell whether the watchdog is
/// on, so the drive has to show it: it is armed with zero torque and then left alone, until a heartbeat
/// reports that the watchdog has disarmed it. One that stays armed is refused. A drive that reports an
/// expired watchdog when it is first heard has shown it already. Then it is armed to stay, and fed.
class ODriveCanSimple final : public JointDrive {
 public:
  explicit ODriveCanSimple(const JointDriveConfig& config);

  bool Prepare(int64_t now_ns, FrameList* out) override;
  void BringUp(int64_t now_ns, FrameList* out) override;
  void RequestSample(int64_t now_ns, FrameList* out) override;
  /// Out of torque mode: zero, for the drive may be armed to prove its watchdog.
  void CommandTorque(double tau_Nm, FrameList* out) override;
  void QuickStop(FrameList* out) override;
  void Disable(FrameList* out) override;
  Reception OnFrame(const CanFrame& frame) override;
  std::vector<CanFilter> Filters() const override;
  void Reset() override;

  DriveState state() const override;
  DriveWatchdog watchdog() const override { return watchdog_; }
  uint32_t error_code() const override { return heartbeat_.error; }
  const JointSample& sample() const override { return sample_; }
  std::string Explain() const override;

  /// Attempts to arm that may end in an error report before it is held to be a fault: the first error may be
  /// an old one, and the frame that clears it may be lost.

 private:
  enum class Phase {
    kBringUp,  ///< to be armed, or armed and not confirmed
    kTorque,   ///< confirmed
    kEnded,    ///< left, stopped, refused or given up: silent until Reset()
  };

  void Arm(FrameList* out);
  bool IsSilent(int64_t now_ns) const;
  void OnHeartbeat(const odrive::Heartbeat& heartbeat, int64_t stamp_ns);

  JointDriveConfig config_;
  odrive::Firmware firmware_;
  int heartbeats_to_trip_;  ///< heartbeats in which a watchdog that is on must have shown
  odrive::Heartbeat heartbeat_;
  bool heard_ = false;
  bool heartbeat_lost_ = false;  ///< while in torque mode
  int64_t heartbeat_ns_ = 0;     ///< the last one
  DriveWatchdog watchdog_ = DriveWatchdog::kUnproved;
  Phase phase_ = Phase::kBringUp;
  int attempts_ = 0;  ///< to arm, since the watchdog was last in doubt
  int heartbeats_since_attempt_ = 0;
  JointSample sample_;
};

}  // namespace armada
