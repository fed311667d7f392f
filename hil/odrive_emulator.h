#pragma once

#include <cstdint>

#include "firmware/can/odrive_messages.h"
#include "hil/delayed_torque.h"
#include "hil/emulated_drive.h"
#include "hil/joint_sensor.h"
#include "hil/periodic.h"

namespace armada {

/// One emulated ODrive axis, calibrated and with a torque loop that is exact but for its latency. In torque
/// control and closed loop it produces the last torque input, within its own limit. As the firmware does: it
/// starts idle in position control, keeps the torque input through a disarm, is fed by every frame with its
/// node id, and latches errors (watchdog, also while idle; e-stop; its own) that disarm until they are
/// cleared. Control modes other than torque and states other than idle and closed loop are not emulated: the
/// former produce no torque, the latter are not entered.
class ODriveEmulator final : public EmulatedDrive {
 public:
  /// `joint` gives address, gear, direction, offset and the drive's torque limit. `seed`: of the velocity
  /// noise.
  ODriveEmulator(const JointDriveConfig& joint, const EmulatedDriveConfig& config, uint64_t seed);

  void OnFrame(double t_s, const CanFrame& frame, const JointTruth& truth, FrameList* out) override;
  void OnTime(double t_s, const JointTruth& truth, FrameList* out) override;
  double Torque(double t_s) const override;
  double NextTorqueChange(double t_s) const override;
  double NextEvent(double t_s) const override;
  bool ProducesTorque() const override { return state_ == odrive::AxisState::kClosedLoop; }
  void Fail(double t_s, FrameList* out) override;

 private:
  void OnDataFrame(double t_s, odrive::Command command, const CanFrame& frame);
  void CheckWatchdog(double t_s);
  void Disarm(uint32_t error);
  double WatchdogDeadline_s() const;
  /// Lets the torque that now belongs to the drive's state and input take over one latency after `t_s`.
  void ScheduleTorque(double t_s);
  void SendHeartbeat(FrameList* out) const;
  void SendEstimates(const JointTruth& truth, FrameList* out);

  JointDriveConfig joint_;
  odrive::Firmware firmware_;
  double watchdog_s_;
  JointSensor sensor_;
  DelayedTorque<> torque_;

  odrive::AxisState state_ = odrive::AxisState::kIdle;
  odrive::ControllerMode mode_;
  uint32_t error_ = 0;
  float input_torque_Nm_ = 0.0f;  ///< motor side
  double last_fed_s_ = 0.0;
  Periodic heartbeat_;
  Periodic feedback_;
};

}  // namespace armada
