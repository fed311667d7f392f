#pragma once

#include "firmware/core/parameter.h"
#include "firmware/core/types.h"

namespace armada {

/// Gains of (1.2) and (1.8), as diagonals. In the configuration one number stands for all joints or axes.
struct GainsConfig {
  JointVector K_s_Nms_rad = JointVector::Constant(1, 100.0);
  TaskVector K_x_Ns_m = TaskVector::Constant(1, 50.0);
  JointVector K_r_Nm = JointVector::Constant(1, 60.0);

  void Visit(ParameterVisitor& parameter) {
    parameter(
        {"K_s_Nms_rad", "N m s/rad", 1e-6, 1e6, "K_s of (1.2), joint damping on s; one value or one a joint"},
        K_s_Nms_rad);
    parameter(
        {"K_x_Ns_m", "N s/m", 0, 1e6, "K_x of (1.2), task-space damping on J s; one value or one an axis"},
        K_x_Ns_m);
    parameter({"K_r_Nm", "N m", 0, 1e6,
               "K_r of (1.2), at least the 2-norm of the disturbance; one value or one a joint"},
              K_r_Nm);
  }

  /// Single values spread over `dof` joints and `task_dim` axes.
  void Expand(int dof, int task_dim) {
    if (K_s_Nms_rad.size() == 1) K_s_Nms_rad = JointVector::Constant(dof, K_s_Nms_rad[0]);
    if (K_r_Nm.size() == 1) K_r_Nm = JointVector::Constant(dof, K_r_Nm[0]);
    if (K_x_Ns_m.size() == 1) K_x_Ns_m = TaskVector::Constant(task_dim, K_x_Ns_m[0]);
  }
};

}  // namespace armada
