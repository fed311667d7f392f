#pragma once

#include "firmware/can/joint_drive.h"
#include "firmware/can/odrive_messages.h"

namespace armada {

/// Master's side of one ODrive axis in torque control over CANSimple.
///   q = direction 2 pi turns / gear_ratio + offset,  tau = direction gear_ratio tau_motor.
/// The bring-up runs on the drive's heartbeats, so it needs no clock: its four frames are sent when a
/// heartbeat has been heard, and again when two more did not confirm closed loop, which bounds their rate to
/// one in 200 ms.
class ODriveCanSimple final : public JointDrive {
 public:
  explicit ODriveCanSimple(const JointDriveConfig& config,
                           odrive::Firmware firmware = odrive::Firmware::kV06);

  void Enable(FrameList* out) override;
  void RequestSample(FrameList* out) override;
  void CommandTorque(double tau_Nm, FrameList* out) override;
  void Disable(FrameList* out) override;
  bool OnFrame(const CanFrame& frame) override;

  DriveState state() const override;
  uint32_t error_code() const override { return heartbeat_.error; }
  const JointSample& sample() const override { return sample_; }

  /// Allows a bring-up again after the drive has left closed loop, was disabled, or is in kFault. The
  /// decision of a person or of a supervisor, never of a codec.
  void Reset();

  /// Bring-ups that may end in an error report before it is held to be a fault: the first error may be an old
  /// one, and the frame that clears it may be lost.
  static constexpr int kMaxAttempts = 5;

 private:
  enum class Phase {
    kBringUp,  ///< Enable may send
    kTorque,   ///< confirmed
    kEnded,    ///< left, disabled or given up: silent until Reset()
  };

  void OnHeartbeat(const odrive::Heartbeat& heartbeat);

  JointDriveConfig config_;
  odrive::Firmware firmware_;
  odrive::Heartbeat heartbeat_;
  bool heard_ = false;
  Phase phase_ = Phase::kBringUp;
  int attempts_ = 0;  ///< bring-ups sent
  int heartbeats_since_attempt_ = 0;
  JointSample sample_;
};

}  // namespace armada
