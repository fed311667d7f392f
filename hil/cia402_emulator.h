#pragma once

#include <cstdint>

#include "hil/cia402_machine.h"
#include "hil/cia402_node.h"
#include "hil/delayed_torque.h"
#include "hil/emulated_drive.h"
#include "hil/joint_sensor.h"

namespace armada {

/// One emulated CiA 402 servo drive on CANopen, with a torque loop that is exact but for its latency and what
/// the wire rounds. In operation enabled and cyclic synchronous torque it produces the target torque, within
/// max torque (6072h). Losing the master (silent RPDO, silent heartbeat, out of operational) while the power
/// is on acts as abort connection option code 6007h says; quick stops and faults brake as 605Ah and 605Eh
/// say.
///
/// Braking is a damper, not a ramp: full torque from kFullBraking_rad_s on, less below, until the joint rests
/// or kMaxBraking_s have passed. Modes other than cyclic synchronous torque are not supported, as 6502h
/// tells.
class Cia402Emulator final : public EmulatedDrive {
 public:
  static constexpr double kBrakePeriod_s = 0.001;
  static constexpr double kFullBraking_rad_s = 2.0;  ///< joint side
  static constexpr double kRest_rad_s = 0.02;
  static constexpr double kMaxBraking_s = 1.0;

  /// `joint` gives address, units, gear, direction, offset and the drive's torque limit. `seed`: of the
  /// velocity noise.
  Cia402Emulator(const JointDriveConfig& joint, const EmulatedDriveConfig& config, uint64_t seed);

  void OnFrame(double t_s, const CanFrame& frame, const JointTruth& truth, FrameList* out) override;
  void OnTime(double t_s, const JointTruth& truth, FrameList* out) override;
  double Torque(double t_s) const override;
  double NextTorqueChange(double t_s) const override;
  double NextEvent(double t_s) const override;
  bool ProducesTorque() const override { return machine_.PowerOn(); }

  void Fail(double t_s, FrameList* out) override;
  /// An error of the drive itself, for example 2310h, continuous over-current: EMCY, reaction, fault.
  void Fail(double t_s, uint16_t error_code, FrameList* out);

  cia402::PowerState power_state() const { return machine_.state(); }

 private:
  /// What follows for power and torque from what the node has received or missed.
  void React(double t_s, FrameList* out);
  void OnLoss(uint16_t error_code, FrameList* out);
  void StartBraking(double t_s);
  void Brake(double t_s, const JointTruth& truth);
  void Follow(double t_s);
  void Measure(double t_s, const JointTruth& truth);
  double TorqueUnit_Nm() const;
  double TorqueLimit_units() const;
  double ToJoint_Nm(double units) const;
  int64_t BrakeOption() const;

  JointDriveConfig joint_;
  Cia402Node node_;
  Cia402Machine machine_;
  JointSensor sensor_;
  DelayedTorque<> torque_;
  double target_Nm_ = 0.0;  ///< joint side, last given to `torque_`
  bool braking_ = false;
  double brake_start_s_ = 0.0;
  double brake_s_ = 0.0;  ///< next step of the brake
  double brake_Nm_ = 0.0;
};

}  // namespace armada
