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
