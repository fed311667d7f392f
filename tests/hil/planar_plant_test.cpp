#include "hil/planar_plant.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "tests/support/random_arms.h"

namespace armada {
namespace {

PlanarPlant RandomPlant(RandomArms& random, const PlanarArmConfig& config) {
  PlanarPlant plant(config);
  plant.q_rad = ToPlant(random.Numbers(config.dof, 3.0));
  plant.dq_rad_s = ToPlant(random.Numbers(config.dof, 2.0));
  return plant;
}

// Two derivations, the plant's recursion and the controller's H, C and g, agree.
TEST(PlanarPlant, AccelerationIsThatOfTheEquationsOfMotion) {
  RandomArms random(1);
  for (const PlanarArm& arm : random.AllKinds(50)) {
    const PlanarPlant plant = RandomPlant(random, arm.config());
    const JointVector q = FromPlant(plant, plant.q_rad);
    const JointVector dq = FromPlant(plant, plant.dq_rad_s);
    const JointVector tau_Nm = random.Numbers(arm.dof(), 50.0);
    const PlanarArm::Posture at = arm.At(q);
    const ParameterVector theta = arm.Theta();
    const JointVector expected = arm.Inertia(at, theta).ldlt().solve(tau_Nm - arm.Bias(at, dq, theta));
    const JointVector actual =
        FromPlant(plant, plant.Acceleration(plant.q_rad, plant.dq_rad_s, ToPlant(tau_Nm)));
    EXPECT_LT((actual - expected).norm(), 1e-9 * (1.0 + expected.norm())) << arm.dof() << " joints";
  }
}

// The step's fifth-order local error: half the step, a sixteenth of the drift at least.
TEST(PlanarPlant, ConservesEnergyWithoutInputToTheOrderOfRungeKutta) {
  RandomArms random(2);
  for (const PlanarArm& arm : random.AllKinds(2)) {
    const PlanarPlant start = RandomPlant(random, arm.config());
    const auto drift = [&](double dt_s) {
      PlanarPlant plant = start;
      for (int k = 0; k < std::lround(0.2 / dt_s); ++k) plant.Step({}, dt_s);
      return std::abs(plant.Energy() - start.Energy());
    };
    const double scale = 1.0 + std::abs(start.Energy());
    EXPECT_LT(drift(0.001), 1e-5 * scale) << arm.dof() << " joints";
    EXPECT_LT(drift(0.0005), drift(0.001) / 14.0 + 1e-12 * scale) << arm.dof() << " joints";
  }
}

TEST(PlanarPlant, EnergyGainIsTheTorquesWork) {
  RandomArms random(3);
  for (const PlanarArm& arm : random.AllKinds(3)) {
    PlanarPlant plant = RandomPlant(random, arm.config());
    const PlanarPlant::Joints tau_Nm = ToPlant(random.Numbers(arm.dof(), 20.0));
    const double before = plant.Energy();
    const PlanarPlant::Joints q_before = plant.q_rad;
    for (int k = 0; k < 50; ++k) plant.Step(tau_Nm, 0.001);
    double work_J = 0.0;  // constant torque
    for (size_t i = 0; i < kMaxDof; ++i) work_J += tau_Nm[i] * (plant.q_rad[i] - q_before[i]);
    EXPECT_NEAR(plant.Energy() - before, work_J, 1e-5 * (1.0 + std::abs(before)));
  }
}

// The step turns cosines and sines by a series where the turn is small: no digit may be lost, at any speed.
TEST(PlanarPlant, StepsByTheClassicalRungeKuttaMethodAtAnySpeed) {
  RandomArms random(6);
  for (const PlanarArm& arm : random.AllKinds(3)) {
    for (const double speed_rad_s : {1.0, 50.0, 200.0, 5000.0}) {  // the series ends at 60
      PlanarPlant plant = RandomPlant(random, arm.config());
      for (double& dq : plant.dq_rad_s) dq *= speed_rad_s / 2.0;
      const PlanarPlant::Joints tau_Nm = ToPlant(random.Numbers(arm.dof(), 50.0));
      const JointVector q = FromPlant(plant, plant.q_rad);
      const JointVector dq = FromPlant(plant, plant.dq_rad_s);
      const auto rate = [&](const JointVector& q_stage, const JointVector& dq_stage) {
        return FromPlant(plant, plant.Acceleration(ToPlant(q_stage), ToPlant(dq_stage), tau_Nm));
      };
      constexpr double h = 0.001;
      const JointVector k1 = rate(q, dq);
      const JointVector k2 = rate(q + h / 2 * dq, dq + h / 2 * k1);
      const JointVector k3 = rate(q + h / 2 * (dq + h / 2 * k1), dq + h / 2 * k2);
      const JointVector k4 = rate(q + h * (dq + h / 2 * k2), dq + h * k3);
      const JointVector change = h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
      plant.Step(tau_Nm, h);
      EXPECT_LT((FromPlant(plant, plant.dq_rad_s) - dq - change).norm(), 1e-11 * (dq.norm() + change.norm()))
          << arm.dof() << " joints at " << speed_rad_s << " rad/s";
    }
  }
}

TEST(PlanarPlant, AStateThatIsSetIsWhereTheNextStepStarts) {
  RandomArms random(7);
  const PlanarArmConfig config = random.Config(3, 9.81);
  PlanarPlant fresh = RandomPlant(random, config);
  PlanarPlant used = RandomPlant(random, config);
  used.Step({1, 2, 3}, 0.001);
  used.q_rad = fresh.q_rad;
  used.dq_rad_s = fresh.dq_rad_s;
  EXPECT_EQ(used.EndEffector().x_m, fresh.EndEffector().x_m);
  used.Step({1, 2, 3}, 0.001);
  fresh.Step({1, 2, 3}, 0.001);
  EXPECT_EQ(used.q_rad, fresh.q_rad);
  EXPECT_EQ(used.dq_rad_s, fresh.dq_rad_s);
}

TEST(PlanarPlant, StartsStretchedOut) {
  PlanarArmConfig config;
  config.dof = 2;
  EXPECT_NEAR(PlanarPlant(config).EndEffector().x_m[0], 2.0, 1e-15);
}

TEST(PlanarPlant, OneLinkIsAPendulum) {
  PlanarArmConfig config;
  config.dof = 1;
  config.links[0] = {2.0, 1.0, 0.4, 0.5};
  config.gravity_m_s2 = 9.81;
  PlanarPlant plant(config);
  plant.q_rad[0] = 0.7;
  plant.dq_rad_s[0] = 3.0;  // does not matter
  const double inertia = 0.5 + 2.0 * 0.4 * 0.4;
  const double expected = (5.0 - 2.0 * 9.81 * 0.4 * std::cos(0.7)) / inertia;
  EXPECT_NEAR(plant.Acceleration(plant.q_rad, plant.dq_rad_s, {5.0})[0], expected, 1e-12);
}

TEST(PlanarPlant, ConstantTorqueOnOneLinkGivesAParabola) {
  PlanarArmConfig config;
  config.dof = 1;
  config.links[0] = {2.0, 1.0, 0.5, 1.5};  // 2 kg m^2 about the joint
  PlanarPlant plant(config);
  for (int k = 0; k < 500; ++k) plant.Step({4.0}, 0.001);
  EXPECT_NEAR(plant.dq_rad_s[0], 2.0 * 0.5, 1e-12);
  EXPECT_NEAR(plant.q_rad[0], 0.5 * 2.0 * 0.25, 1e-12);
}

TEST(PlanarPlant, EndEffectorAgreesWithTheControllersKinematics) {
  RandomArms random(4);
  for (const PlanarArm& arm : random.AllKinds(20)) {
    const PlanarPlant plant = RandomPlant(random, arm.config());
    const PlanarArm::Posture at = arm.At(FromPlant(plant, plant.q_rad));
    const TaskVector x = arm.Position(at);
    const TaskVector v = arm.Jacobian(at) * FromPlant(plant, plant.dq_rad_s);
    const PlanarPlant::Tip tip = plant.EndEffector();
    for (size_t c = 0; c < 2; ++c) {
      EXPECT_NEAR(tip.x_m[c], x[static_cast<Eigen::Index>(c)], 1e-12);
      EXPECT_NEAR(tip.v_m_s[c], v[static_cast<Eigen::Index>(c)], 1e-11);
    }
  }
}

TEST(PlanarPlant, JointsThatItDoesNotHaveStayAtZero) {
  RandomArms random(5);
  PlanarPlant plant(random.Config(2, 9.81));
  for (int k = 0; k < 20; ++k) plant.Step({1, 2, 3, 4, 5, 6, 7}, 0.001);
  for (size_t i = 2; i < kMaxDof; ++i) {
    EXPECT_EQ(plant.q_rad[i], 0.0);
    EXPECT_EQ(plant.dq_rad_s[i], 0.0);
  }
}

}  // namespace
}  // namespace armada
