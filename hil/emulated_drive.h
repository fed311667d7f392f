#pragma once

#include <memory>

#include "firmware/can/frame_list.h"
#include "firmware/can/joint_drive_config.h"
#include "firmware/core/parameter.h"

namespace armada {

/// True state of a joint, joint side.
struct JointTruth {
  double position_rad = 0.0;
  double velocity_rad_s = 0.0;
};

/// What an emulated drive is like, besides its JointDriveConfig.
struct EmulatedDriveConfig {
  double latency_s = 0.001;            ///< from a command's frame to its torque
  double encoder_counts_per_turn = 0;  ///< of the motor; 0: continuous
  double velocity_noise_rad_s = 0.0;   ///< standard deviation, joint side
  double feedback_period_s = 0.0;      ///< of what the drive sends by itself; 0: on request only
  double watchdog_s = 0.03;            ///< as set in drives whose protocol cannot set it; 0: off

  void Visit(ParameterVisitor& parameter) {
    parameter({"latency_s", "s", 0, 0.1, "from a command's frame to its torque"}, latency_s);
    parameter({"encoder_counts_per_turn", "", 0, 1e8, "encoder counts per motor turn; 0: continuous"},
              encoder_counts_per_turn);
    parameter(
        {"velocity_noise_rad_s", "rad/s", 0, 10, "standard deviation of the velocity estimate, joint side"},
        velocity_noise_rad_s);
    parameter({"feedback_period_s", "s", 0, 1,
               "ODrive: period of the cyclic encoder estimates; 0: on request only"},
              feedback_period_s);
    parameter({"watchdog_s", "s", 0, 10,
               "silence after which the drive disarms, in drives whose protocol cannot set it; 0: off"},
              watchdog_s);
  }
};

/// The drive's side of one joint, as the emulated plant sees it: frames in, frames and torque out. Driven by
/// time, so the same code runs in virtual and in real time; 0 is the drive's power-up. Calls to OnFrame and
/// OnTime come with times that do not decrease; Torque and the two Next... functions are asked for times not
/// before the last of them.
class EmulatedDrive {
 public:
  virtual ~EmulatedDrive() = default;

  /// A frame on the bus at time `t_s`, while the joint is at `truth`. Replies are appended to `out`. Frames
  /// that are not for this drive are ignored.
  virtual void OnFrame(double t_s, const CanFrame& frame, const JointTruth& truth, FrameList* out) = 0;

  /// What the drive does by itself up to `t_s`: heartbeats, cyclic estimates, watchdog. Call at NextEvent()
  /// or later; what fell due more than once meanwhile is sent once.
  virtual void OnTime(double t_s, const JointTruth& truth, FrameList* out) = 0;

  /// Joint-side torque [N m] at `t_s`. Constant from one change to the next; a change at `t_s` itself has
  /// happened.
  virtual double Torque(double t_s) const = 0;

  /// First time after `t_s` at which Torque() may change without a frame; infinity when there is none.
  virtual double NextTorqueChange(double t_s) const = 0;

  /// First time, not before `t_s`, at which OnTime has something to do.
  virtual double NextEvent(double t_s) const = 0;

  /// True while the drive's power stage is on.
  virtual bool ProducesTorque() const = 0;

  /// Something in the drive fails: it reports an error of its kind, and takes its power away as it then does.
  virtual void Fail(double t_s, FrameList* out) = 0;
};

/// The drive that speaks the joint's profile. `seed`: of the sensor's noise.
std::unique_ptr<EmulatedDrive> MakeEmulatedDrive(const JointDriveConfig& joint,
                                                 const EmulatedDriveConfig& config, uint64_t seed);

}  // namespace armada
