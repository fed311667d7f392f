#pragma once

#include <cstdint>

#include "firmware/can/damiao_messages.h"
#include "firmware/can/mit_messages.h"
#include "hil/delayed_torque.h"
#include "hil/emulated_drive.h"
#include "hil/joint_sensor.h"

namespace armada {

/// One emulated drive that speaks MIT packed frames, profiles kMiniCheetah, kCubeMars, kDamiao, with a torque
/// loop that is exact but for its latency and the packing. As the firmware does: it starts disabled, keeps
/// commands while it is disabled, answers every frame, is fed by commands (Damiao: by every frame to its
/// node) and only ages while enabled. On time-out mini-cheetah and CubeMars zero the command and follow the
/// next one; Damiao disables itself with a fault that only "clear fault" ends, and serves its registers.
/// Gains are not emulated: a command that has any gives no torque.
class MitEmulator final : public EmulatedDrive {
 public:
  /// `joint` gives addresses, ranges, gear, direction, offset and the drive's torque limit. Damiao ignores
  /// `config.watchdog_s`: its TIMEOUT register starts at 0, off. `seed`: of the velocity noise.
  MitEmulator(const JointDriveConfig& joint, const EmulatedDriveConfig& config, uint64_t seed);

  void OnFrame(double t_s, const CanFrame& frame, const JointTruth& truth, FrameList* out) override;
  void OnTime(double t_s, const JointTruth& truth, FrameList* out) override;
  double Torque(double t_s) const override;
  double NextTorqueChange(double t_s) const override;
  double NextEvent(double t_s) const override;
  bool ProducesTorque() const override { return enabled_; }

  void Fail(double t_s, FrameList* out) override;
  /// The drive fails by itself: status of a Damiao reply, error code of a CubeMars one. The power stage goes
  /// off. 0: the cause is gone.
  void Fail(uint8_t status);

 private:
  bool is_damiao() const { return joint_.profile == DriveProfile::kDamiao; }
  void OnRegister(const damiao::RegisterAccess& request, FrameList* out);
  uint32_t ReadRegister(damiao::Register reg, bool* known) const;
  void WriteRegister(damiao::Register reg, uint32_t raw);
  void OnSpecial(double t_s, mit::Special special, const JointTruth& truth);
  void PowerOff();
  void CheckTimeout(double t_s);
  double Deadline_s() const;
  void ScheduleTorque(double t_s);
  double MotorPosition_rad(const JointSensor::Reading& reading) const;
  void SendState(double t_s, const JointTruth& truth, FrameList* out);

  JointDriveConfig joint_;
  JointSensor sensor_;
  DelayedTorque<> torque_;
  double timeout_s_;  ///< 0: off
  uint32_t control_mode_ = damiao::kMitMode;
  mit::Command command_;
  bool enabled_ = false;
  bool timed_out_ = false;  ///< and not fed since
  uint8_t status_ = 0;      ///< fault of a Damiao drive, error of a CubeMars
  double last_fed_s_ = 0.0;
  double zero_rad_ = 0.0;  ///< motor side
};

}  // namespace armada
