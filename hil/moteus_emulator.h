#pragma once

#include <cstdint>
#include <limits>

#include "hil/delayed_torque.h"
#include "hil/emulated_drive.h"
#include "hil/joint_sensor.h"
#include "hil/moteus_subframes.h"

namespace armada {

/// One emulated moteus controller, calibrated, with a torque loop that is exact but for its latency. As the
/// firmware does: every command is valid for its watchdog time; after that it damps the joint, in mode 11,
/// until it is stopped; a fault, too, lasts until a stop; from stopped to position takes some milliseconds;
/// queries feed nothing. Reads and writes any of its registers, as any type, in any sequence of subframes.
/// Not emulated: gains (a command that has any gives no torque), modes other than stopped and position (not
/// entered), limits of the configuration, registers not in moteus::Register.
class MoteusEmulator final : public EmulatedDrive {
 public:
  static constexpr double kEnabling_s = 0.01;          ///< from a stop to following commands
  static constexpr double kDefaultTimeout_s = 0.1;     ///< servo.default_timeout_s
  static constexpr double kTimeoutMaxTorque_Nm = 5.0;  ///< servo.timeout_max_torque_Nm
  static constexpr double kDamping_Nms = 0.05;         ///< servo.pid_position.kd, N m per turn/s
  static constexpr double kDampingPeriod_s = 0.001;    ///< of the emulated damping
  static constexpr double kSupply_V = 12.0;
  static constexpr double kTemperature_degC = 20.0;

  /// `joint` gives address, gear, direction, offset and the drive's torque limit. `config.watchdog_s` is not
  /// used: commands set it. `seed`: of the velocity noise.
  MoteusEmulator(const JointDriveConfig& joint, const EmulatedDriveConfig& config, uint64_t seed);

  void OnFrame(double t_s, const CanFrame& frame, const JointTruth& truth, FrameList* out) override;
  void OnTime(double t_s, const JointTruth& truth, FrameList* out) override;
  double Torque(double t_s) const override;
  double NextTorqueChange(double t_s) const override;
  double NextEvent(double t_s) const override;
  bool ProducesTorque() const override { return mode_ == moteus::Mode::kPosition; }

  void Fail(double t_s, FrameList* out) override;
  /// The drive fails by itself, with this fault.
  void Fail(uint8_t fault);

 private:
  static constexpr double kNever = std::numeric_limits<double>::infinity();
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

  /// Registers 0x020 to 0x027, with what holds when a frame does not write them.
  struct Command {
    moteus::Mode mode = moteus::Mode::kStopped;
    double position_turns = 0.0;
    double velocity_turns_s = 0.0;
    double torque_Nm = 0.0;
    double kp_scale = 1.0;
    double kd_scale = 1.0;
    double max_torque_Nm = kNaN;
    double stop_position_turns = kNaN;
    double timeout_s = 0.0;
  };

  /// Time passes: enabled, timed out, damped.
  void Update(double t_s, const JointTruth& truth);
  /// Takes over what a frame has written.
  void Execute(double t_s);
  void ScheduleTorque(double t_s);
  void PowerOff(moteus::Mode mode);
  /// False: the frame makes no sense from here on.
  bool OnWrite(unsigned type_and_count, MoteusReader* reader, MoteusWriter* answer);
  bool OnRead(unsigned type_and_count, double t_s, MoteusReader* reader, MoteusWriter* answer);
  uint32_t Write(moteus::Register reg, double value);
  bool Read(moteus::Register reg, MoteusType type, double t_s, double* value) const;
  /// Null for a register that is not one of a command.
  static double Command::*FieldOf(moteus::Register reg);

  JointDriveConfig joint_;
  JointSensor sensor_;
  DelayedTorque<> torque_;
  JointSensor::Reading reading_;  ///< for the frame being answered
  moteus::Mode mode_ = moteus::Mode::kStopped;
  uint8_t fault_ = 0;
  Command command_;
  bool command_valid_ = false;  ///< this frame has written the mode
  double enabled_at_s_ = kNever;
  double deadline_s_ = kNever;
  double next_damping_s_ = kNever;
  double damping_Nm_ = 0.0;  ///< joint side
};

}  // namespace armada
