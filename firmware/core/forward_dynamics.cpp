#include "firmware/core/forward_dynamics.h"

#include <Eigen/Cholesky>

namespace armada {

JointVector Acceleration(const PlanarArm& arm, const ParameterVector& theta, const JointState& state,
                         const JointVector& net_Nm) {
  const PlanarArm::Posture at = arm.At(state.q_rad);
  return arm.Inertia(at, theta).llt().solve(net_Nm - arm.Bias(at, state.dq_rad_s, theta));
}

JointState Integrate(const PlanarArm& arm, const ParameterVector& theta, const JointState& state,
                     const JointVector& net_Nm, double dt_s) {
  const auto& [q, dq] = state;
  const double half_s = 0.5 * dt_s;
  const JointVector a_1 = Acceleration(arm, theta, state, net_Nm);
  const JointVector v_2 = dq + half_s * a_1;
  const JointVector a_2 = Acceleration(arm, theta, {q + half_s * dq, v_2}, net_Nm);
  const JointVector v_3 = dq + half_s * a_2;
  const JointVector a_3 = Acceleration(arm, theta, {q + half_s * v_2, v_3}, net_Nm);
  const JointVector v_4 = dq + dt_s * a_3;
  const JointVector a_4 = Acceleration(arm, theta, {q + dt_s * v_3, v_4}, net_Nm);
  return {q + (dt_s / 6.0) * (dq + 2.0 * (v_2 + v_3) + v_4),
          dq + (dt_s / 6.0) * (a_1 + 2.0 * (a_2 + a_3) + a_4)};
}

}  // namespace armada
