#pragma once

#include <array>
#include <cstdint>
#include <random>

#include "firmware/can/joint_drive.h"
#include "firmware/can/odrive_messages.h"
#include "hil/emulated_drive.h"

namespace armada {

/// One emulated ODrive axis, calibrated and with a torque loop that is exact but for its latency. In torque
/// control and closed loop it produces the last torque input, within its own limit. As the firmware does: it
/// starts idle in position control, keeps the torque input through a disarm, is fed by every frame with its
/// node id, and latches errors (watchdog, also while idle; e-stop) that disarm until they are cleared.
/// Control modes other than torque and states other than idle and closed loop are not emulated: the former
/// produce no torque, the latter are not entered.
class ODriveEmulator final : public EmulatedDrive {
 public:
  static constexpr double kHeartbeatPeriod_s = 0.1;

  /// `joint` gives address, gear, direction, offset and the drive's torque limit. `seed`: of the velocity
  /// noise.
  ODriveEmulator(const JointDriveConfig& joint, const EmulatedDriveConfig& config, uint64_t seed);

  void OnFrame(double t_s, const CanFrame& frame, const JointTruth& truth, FrameList* out) override;
  void OnTime(double t_s, const JointTruth& truth, FrameList* out) override;
  double Torque(double t_s) const override;
  double NextTorqueChange(double t_s) const override;
  double NextEvent(double t_s) const override;
  bool ProducesTorque() const override { return state_ == odrive::AxisState::kClosedLoop; }

 private:
  /// A torque [joint side] and the time from which it holds.
  struct TorqueChange {
    double t_s = 0.0;
    double tau_Nm = 0.0;
  };
  /// Event k of a periodic kind is due at k period.
  struct Periodic {
    double period_s = 0.0;  ///< 0: never
    uint64_t next = 0;

    double due_s() const;
    bool Take(double t_s);
  };

  void OnDataFrame(double t_s, odrive::Command command, const CanFrame& frame);
  void CheckWatchdog(double t_s);
  double WatchdogDeadline_s() const;
  /// Lets the torque that now belongs to the drive's state and input take over one latency after `t_s`.
  void ScheduleTorque(double t_s);
  void ApplyTorqueChanges(double t_s);
  void SendHeartbeat(FrameList* out) const;
  void SendEstimates(const JointTruth& truth, FrameList* out);

  JointDriveConfig joint_;
  EmulatedDriveConfig config_;
  std::mt19937_64 random_;

  odrive::AxisState state_ = odrive::AxisState::kIdle;
  odrive::ControllerMode mode_;
  uint32_t error_ = 0;
  float input_torque_Nm_ = 0.0f;  ///< motor side
  double last_fed_s_ = 0.0;
  Periodic heartbeat_;
  Periodic feedback_;

  double torque_Nm_ = 0.0;  ///< in force before the first of the pending changes
  std::array<TorqueChange, 8> pending_{};
  size_t pending_count_ = 0;
};

}  // namespace armada
