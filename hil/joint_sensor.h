#pragma once

#include <cstdint>
#include <random>

#include "hil/emulated_drive.h"

namespace armada {

/// What a drive's encoder makes of the joint, in the motor's units.
class JointSensor {
 public:
  struct Reading {
    double position_turns = 0.0;  ///< of the motor, from the drive's zero
    double velocity_turns_s = 0.0;
  };

  /// `counts_per_turn`: resolution of the position, motor side; 0: continuous. `seed`: of the velocity noise.
  JointSensor(const JointDriveConfig& joint, double counts_per_turn, double velocity_noise_rad_s,
              uint64_t seed);

  Reading Read(const JointTruth& truth);

 private:
  double offset_rad_;
  double turns_per_rad_;  ///< motor turns per radian of the joint, with sign
  double counts_per_turn_;
  double velocity_noise_rad_s_;
  std::mt19937_64 random_;
};

/// Joint-side torque of a motor torque, within the drive's limit.
double JointTorque(const JointDriveConfig& joint, double motor_Nm);

}  // namespace armada
