#include "hil/start_state.h"

#include <Eigen/Cholesky>

#include "hil/random.h"

namespace armada {
JointVector BentElbow(const PlanarArm& arm) {
  JointVector q = JointVector::Constant(arm.dof(), 1.2);
  q[0] = 0.3 - arm.config().base_orientation_rad;
  return q;
}

JointVector ReachFrom(const PlanarArm& arm, JointVector q_rad, const TaskVector& x_m) {
  for (int iteration = 0; iteration < 300; ++iteration) {
    const PlanarArm::Posture at = arm.At(q_rad);
    const JacobianMatrix J = arm.Jacobian(at);
    const Eigen::Vector2d error = x_m - arm.Position(at);
    // Damped the more the farther it is off: without that it jumps to and fro over singular postures.
    Eigen::Matrix2d JJt = J * J.transpose();
    JJt.diagonal().array() += 1e-3 + error.squaredNorm();
    const Eigen::Vector2d weighted = JJt.llt().solve(error);
    q_rad += J.transpose() * weighted;
  }
  return q_rad;
}

std::array<double, 3> LargestStartErrors(const StartConfig& start, const LeaderPath& leader) {
  const Zeta at_start = leader.At(0.0);
  // The box lies around its centre, at rest; near the leader, around the leader's own state.
  const auto error = [&](const TaskVector& offset) {
    return start.zeta_range + (start.kind == StartKind::kBox ? offset.cwiseAbs().maxCoeff() : 0.0);
  };
  return {error(at_start.x_m - start.zeta_x_centre_m), error(at_start.v_m_s), error(at_start.a_m_s2)};
}

ArmStart DrawStart(const ScenarioConfig& scenario, size_t index, uint64_t seed, const LeaderPath* leader) {
  const StartConfig& config = scenario.start;
  const PlanarArm arm(scenario.fleet.arms[index].arm);
  const auto arm_id = static_cast<uint64_t>(scenario.fleet.arms[index].id);
  uint64_t draws = 0;
  const auto draw = [&](double low, double high) {
    return Uniform(RandomBits(seed, kStartStream, arm_id, draws++), low, high);
  };

  ArmStart start;
  const auto dof = static_cast<size_t>(arm.dof());
  if (config.kind == StartKind::kBox) {
    for (size_t i = 0; i < dof; ++i) start.q_rad[i] = draw(-config.q_range_rad, config.q_range_rad);
    for (size_t i = 0; i < dof; ++i) start.dq_rad_s[i] = draw(-config.dq_range_rad_s, config.dq_range_rad_s);
  }

  Zeta& zeta = start.controller.zeta;
  zeta = Zeta::Zero(PlanarArm::kTaskDim);
  zeta.x_m = config.zeta_x_centre_m;
  if (leader != nullptr && config.kind == StartKind::kNearLeader) zeta = leader->At(0.0);
  if (config.kind == StartKind::kNearLeader) {
    TaskVector x = zeta.x_m;
    for (double& x_c : x) x_c += draw(-config.near_leader_m, config.near_leader_m);
    const JointVector q = ReachFrom(arm, BentElbow(arm), x);
    std::copy(q.data(), q.data() + q.size(), start.q_rad.begin());
  }
  for (TaskVector* part : {&zeta.x_m, &zeta.v_m_s, &zeta.a_m_s2}) {
    for (double& element : *part) element += draw(-config.zeta_range, config.zeta_range);
  }
  ParameterVector& theta_hat = start.controller.theta_hat;
  theta_hat.resize(arm.parameter_count());
  for (double& element : theta_hat) element = draw(0.0, config.theta_hat_max);
  if (!scenario.learned.empty() && scenario.learned[index]) {
    theta_hat = scenario.learned[index]->theta_hat;
    start.controller.P_theta = scenario.learned[index]->P_theta;
  }
  return start;
}

}  // namespace armada
