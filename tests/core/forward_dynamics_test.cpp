#include "firmware/core/forward_dynamics.h"

#include <gtest/gtest.h>

#include "tests/support/random_arms.h"

namespace armada {
namespace {

JointState Draw(RandomArms& random, const PlanarArm& arm) {
  return {random.Numbers(arm.dof(), 3.0), random.Numbers(arm.dof(), 3.0)};
}

// The inverse dynamics, (P3), of what the forward dynamics gave is the torque that went in.
TEST(Acceleration, InvertsTheRegressor) {
  RandomArms random(1);
  for (const PlanarArm& arm : random.AllKinds(10)) {
    const JointState state = Draw(random, arm);
    const JointVector tau_Nm = random.Numbers(arm.dof(), 50.0);
    const JointVector ddq = Acceleration(arm, arm.Theta(), state, tau_Nm);
    const JointVector back_Nm =
        arm.Regressor(arm.At(state.q_rad), state.dq_rad_s, state.dq_rad_s, ddq) * arm.Theta();
    EXPECT_LT((back_Nm - tau_Nm).norm(), 1e-9 * (1.0 + ddq.norm()));
  }
}

// Against the simulator's plant, which has its own derivation: the error of a step is of fifth order.
TEST(Integrate, IsOfFourthOrder) {
  RandomArms random(2);
  for (int dof = 1; dof <= 3; ++dof) {
    const PlanarArm arm(random.Config(dof, 9.81));
    const JointState start = Draw(random, arm);
    const JointVector tau_Nm = random.Numbers(dof, 20.0);
    const auto error = [&](double dt_s) {
      PlanarPlant plant(arm.config());
      plant.q_rad = ToPlant(start.q_rad);
      plant.dq_rad_s = ToPlant(start.dq_rad_s);
      constexpr int kFine = 64;
      for (int i = 0; i < kFine; ++i) plant.Step(ToPlant(tau_Nm), dt_s / kFine);
      const JointState end = Integrate(arm, arm.Theta(), start, tau_Nm, dt_s);
      return (end.dq_rad_s - FromPlant(plant, plant.dq_rad_s)).norm() +
             (end.q_rad - FromPlant(plant, plant.q_rad)).norm();
    };
    EXPECT_GT(error(0.02) / error(0.01), 20.0) << dof << " joints";
    EXPECT_LT(error(0.01), 1e-3);
  }
}

}  // namespace
}  // namespace armada
