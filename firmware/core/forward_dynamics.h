#pragma once

#include "firmware/core/planar_arm.h"

namespace armada {

struct JointState {
  JointVector q_rad;
  JointVector dq_rad_s;
};

/// ddq of (1.1) by the model: H(q) ddq = net_Nm - C(q, dq) dq - g(q), with net_Nm = u - d. theta must keep
/// H(q) positive definite.
JointVector Acceleration(const PlanarArm& arm, const ParameterVector& theta, const JointState& state,
                         const JointVector& net_Nm);

/// The joints `dt_s` later under a constant net_Nm: one step of the classical Runge-Kutta method.
JointState Integrate(const PlanarArm& arm, const ParameterVector& theta, const JointState& state,
                     const JointVector& net_Nm, double dt_s);

}  // namespace armada
