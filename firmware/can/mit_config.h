#pragma once

#include "firmware/core/parameter.h"

namespace armada {

/// What a drive that speaks MIT packed frames is set to: both sides must agree, the wire does not tell
/// (docs/can/mit.md has the ranges of common drives).
struct MitConfig {
  int master_id = 0;               ///< 11-bit id of the drive's replies
  double position_max_rad = 12.5;  ///< p is packed into +- this, motor side
  double velocity_max_rad_s = 45.0;
  double torque_max_Nm = 18.0;  ///< motor side
  double kp_max_Nm_rad = 500.0;
  double kd_max_Nms_rad = 5.0;

  void Visit(ParameterVisitor& parameter) {
    parameter({"master_id", "", 0, 0x7FF, "identifier of the drive's replies"}, master_id);
    parameter({"position_max_rad", "rad", 0.1, 1e4, "range of packed positions, +- this, motor side"},
              position_max_rad);
    parameter({"velocity_max_rad_s", "rad/s", 0.1, 1e4, "range of packed velocities, +- this, motor side"},
              velocity_max_rad_s);
    parameter({"torque_max_Nm", "N m", 0.1, 1e4, "range of packed torques, +- this, motor side"},
              torque_max_Nm);
    parameter({"kp_max_Nm_rad", "N m/rad", 0, 1e5, "range of packed position gains, 0 to this"},
              kp_max_Nm_rad);
    parameter({"kd_max_Nms_rad", "N m s/rad", 0, 1e5, "range of packed velocity gains, 0 to this"},
              kd_max_Nms_rad);
  }
};

}  // namespace armada
