// What takes the place of Theorem 2's storage function under the robust law at 100 Hz: V_s = s'H s / 2 at the
// ticks, s = dq - dq_r. A torque that is held cannot act on what disturbs the arm meanwhile, so V_s does not
// vanish; but nothing of s outlives a tick but what the law's damping leaves, and nothing is added but by
// what the disturbance, less what is known of it, does in one tick:
//   |s_k+1|_H <= |s_k|_H / (1 + h lambda_min(H^-1 K)) + h |d - d_hat|_H^-1,   K = K_s + J'K_x J.

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <functional>

#include "firmware/core/robust_law.h"
#include "hil/leader_path.h"
#include "hil/start_state.h"
#include "tests/closed_loop/simulate.h"
#include "tests/support/random_arms.h"

namespace armada {
namespace {

/// d(t), which may know s.
using Push = std::function<JointVector(const JointVector& s)>;

Push None() {
  return [](const JointVector& s) { return JointVector(JointVector::Zero(s.size())); };
}
Push Uniform() {
  return [random = RandomArms(3)](const JointVector& s) mutable { return random.Numbers(s.size(), 40.0); };
}
Push Worst() {
  return [](const JointVector& s) { return JointVector(-40.0 * s.cwiseSign()); };
}

/// One tick: norms in J^1/2.
struct Tick {
  double s_H = 0.0;       ///< |s|_H at its start
  double s_next_H = 0.0;  ///< at its end
  double shrink = 0.0;    ///< 1 / (1 + h lambda_min(H^-1 K))
  double pushed_H = 0.0;  ///< h |d - d_hat|_H^-1
  double theta_error = 0.0;
};

struct Setting {
  size_t index;
  bool knows_theta;
  double torque_limit_Nm;
};

/// Ten seconds of one arm of benign.toml without latency, its leader known.
std::vector<Tick> TicksOf(const Setting& setting, const Push& push) {
  static const ScenarioConfig kScenario = ScenarioNamed("benign");
  const LeaderPath leader(kScenario.leader);
  const ArmEntry& entry = kScenario.fleet.arms[setting.index];
  ControlConfig control = entry.control;
  control.governor.acceleration_rad_s2 = 1e4;  // dq_g = dq_r
  if (setting.knows_theta) control.adaptation.kind = AdaptationKind::kNone;
  const PlanarArm arm(entry.arm);
  const ParameterVector theta = arm.Theta();
  const ArmStart start = DrawStart(kScenario, setting.index, 1, &leader);
  const JointVector limit_Nm = JointVector::Constant(arm.dof(), setting.torque_limit_Nm);
  RobustLaw law(control, arm, setting.knows_theta ? theta : start.controller.theta_hat, limit_Nm, 0.0);
  PlanarPlant plant(entry.arm);
  plant.q_rad = start.q_rad;
  plant.dq_rad_s = start.dq_rad_s;

  const double h = kScenario.fleet.timing.period_s;
  std::vector<Tick> ticks(1000);
  for (size_t k = 0; k < ticks.size(); ++k) {
    const double t_s = static_cast<double>(k) * h;
    const JointVector q = FromPlant(plant, plant.q_rad);
    const JointVector dq = FromPlant(plant, plant.dq_rad_s);
    const JointVector wanted_Nm = law.Torque({q, dq, leader.At(t_s), leader.At(t_s + h), true, h, h});
    const JointVector sent_Nm = wanted_Nm.cwiseMin(limit_Nm).cwiseMax(-limit_Nm);
    law.Applied(wanted_Nm, sent_Nm);

    const JointVector s = dq - law.dq_r_rad_s();
    const JointVector d_Nm = push(s);
    const PlanarArm::Posture at = arm.At(q);
    const JacobianMatrix J = arm.Jacobian(at);
    const Eigen::MatrixXd H = arm.Inertia(at, theta);
    Eigen::MatrixXd K = J.transpose() * control.gains.K_x_Ns_m.asDiagonal() * J;
    K.diagonal() += control.gains.K_s_Nms_rad;
    const Eigen::VectorXd unknown_Nm = d_Nm - law.d_hat_Nm();
    Tick& tick = ticks[k];
    tick.s_H = std::sqrt(s.dot(H * s));
    if (k > 0) ticks[k - 1].s_next_H = tick.s_H;
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> damping(K, H, Eigen::EigenvaluesOnly);
    tick.shrink = 1.0 / (1.0 + h * damping.eigenvalues().minCoeff());
    tick.pushed_H = h * std::sqrt(unknown_Nm.dot(H.llt().solve(unknown_Nm)));
    tick.theta_error = (law.theta_hat() - theta).norm();
    for (int step = 0; step < 10; ++step) plant.Step(ToPlant(sent_Nm - d_Nm), 0.1 * h);
  }
  ticks.pop_back();  // its end was not seen
  return ticks;
}

constexpr size_t kConverged = 200;
constexpr double kUnlimited_Nm = 1e4;

TEST(RobustStorage, ShrinksFromTickToTickButForWhatTheDisturbanceAdds) {
  for (size_t index = 0; index < 7; ++index) {
    for (const Push& push : {None(), Uniform(), Worst()}) {
      const std::vector<Tick> ticks = TicksOf({index, true, kUnlimited_Nm}, push);
      for (size_t k = kConverged; k < ticks.size(); ++k) {
        const Tick& tick = ticks[k];
        ASSERT_LE(tick.s_next_H, tick.shrink * tick.s_H + 1.01 * tick.pushed_H + 1e-5)
            << "arm " << index + 1 << ", tick " << k;
      }
    }
  }
}

// With theta_hat learnt from anywhere in [0, 5] and the arm's own torque limits.
TEST(RobustStorage, IsInTheMeanWhatTheDisturbanceDoesInOneTick) {
  for (size_t index = 0; index < 7; ++index) {
    const std::vector<Tick> ticks = TicksOf({index, false, index < 5 ? 150.0 : 300.0}, Uniform());
    double stored_J = 0.0;
    double pushed_J = 0.0;
    for (size_t k = kConverged; k < ticks.size(); ++k) {
      stored_J += 0.5 * ticks[k].s_next_H * ticks[k].s_next_H;
      pushed_J += 0.5 * ticks[k].pushed_H * ticks[k].pushed_H;
    }
    EXPECT_GT(stored_J, 0.9 * pushed_J) << "arm " << index + 1;
    EXPECT_LT(stored_J, 1.1 * pushed_J) << "arm " << index + 1;
  }
}

// A disturbance that knows s looks like wrong parameters: theta_hat moves away again, and with it the
// theorem's V_i1.
TEST(RobustStorage, DoesNotExtendToTheParameters) {
  for (size_t index = 0; index < 7; ++index) {
    double rise = 0.0;
    double least = std::numeric_limits<double>::infinity();
    for (const Tick& tick : TicksOf({index, false, index < 5 ? 150.0 : 300.0}, Worst())) {
      least = std::min(least, tick.theta_error);
      rise = std::max(rise, tick.theta_error - least);
    }
    EXPECT_GT(rise, 0.5) << "arm " << index + 1;
  }
}

}  // namespace
}  // namespace armada
