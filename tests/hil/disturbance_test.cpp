#include "hil/disturbance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/support/random_arms.h"

namespace armada {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

PlanarPlant SomePlant(uint64_t seed = 1, int dof = 3) {
  RandomArms random(seed);
  PlanarPlant plant(random.Config(dof));
  plant.q_rad = ToPlant(random.Numbers(dof, 3.0));
  return plant;
}

LeaderPath SomeLeader() {
  LeaderConfig config;
  config.axes = {{1.2, 0.5, 0.5, 0.0}, {1.3, 0.3, 0.5, std::numbers::pi / 2.0}};
  return LeaderPath(config);
}

DisturbanceConfig Config(DisturbanceKind kind) {
  DisturbanceConfig config;
  config.kind = kind;
  return config;
}

TEST(Disturbance, EveryKindIsBoundedByItsAmplitude) {
  const LeaderPath leader = SomeLeader();
  const PlanarPlant plant = SomePlant();
  for (const DisturbanceKind kind :
       {DisturbanceKind::kNone, DisturbanceKind::kUniform, DisturbanceKind::kConstant, DisturbanceKind::kSine,
        DisturbanceKind::kAdversarial}) {
    const Disturbance disturbance(Config(kind), 7, 3);
    double largest = 0.0;
    for (int k = 0; k < 20000; ++k) {
      const PlanarPlant::Joints d_Nm = disturbance.At(0.0013 * k, plant, &leader);
      for (const double d : d_Nm) largest = std::max(largest, std::abs(d));
      for (size_t i = 3; i < kMaxDof; ++i) ASSERT_EQ(std::abs(d_Nm[i]), 0.0);
    }
    EXPECT_LE(largest, 40.0);
    if (kind == DisturbanceKind::kNone) {
      EXPECT_EQ(largest, 0.0);
    } else {
      EXPECT_GT(largest, 39.0);
    }
  }
}

TEST(Disturbance, UniformHasMeanZeroAndTheVarianceOfItsBox) {
  const Disturbance disturbance(Config(DisturbanceKind::kUniform), 7, 3);
  const PlanarPlant plant = SomePlant();
  double sum = 0.0;
  double squares = 0.0;
  constexpr int kCount = 20000;
  for (int k = 0; k < kCount; ++k) {
    const double d = disturbance.At(0.01 * k, plant, nullptr)[1];
    sum += d;
    squares += d * d;
  }
  EXPECT_NEAR(sum / kCount, 0.0, 1.0);
  EXPECT_NEAR(squares / kCount, 40.0 * 40.0 / 3.0, 15.0);
}

TEST(Disturbance, UniformIsHeldFromOneChangeToTheNext) {
  const PlanarPlant plant = SomePlant();
  for (const double hold_s : {0.01, 0.0013, 0.1}) {
    DisturbanceConfig config = Config(DisturbanceKind::kUniform);
    config.hold_s = hold_s;
    const Disturbance disturbance(config, 7, 3);
    double t_s = -0.5;
    for (int k = 0; k < 500; ++k) {
      const double end_s = disturbance.NextChange(t_s);
      ASSERT_GT(end_s, t_s);
      ASSERT_LE(end_s, t_s + hold_s * (1.0 + 1e-6));
      const PlanarPlant::Joints value = disturbance.At(t_s, plant, nullptr);
      ASSERT_EQ(disturbance.At(0.5 * (t_s + end_s), plant, nullptr), value);
      ASSERT_EQ(disturbance.At(end_s - 1e-3 * hold_s, plant, nullptr), value);
      ASSERT_NE(disturbance.At(end_s, plant, nullptr), value);
      t_s = end_s;
    }
    EXPECT_NEAR(t_s, -0.5 + 500.0 * hold_s, hold_s);
  }
}

TEST(Disturbance, DependsOnSeedArmJointAndTimeAlone) {
  const PlanarPlant plant = SomePlant(1);
  const auto value = [&](uint64_t seed, int arm, double t_s) {
    return Disturbance(Config(DisturbanceKind::kUniform), seed, arm).At(t_s, plant, nullptr);
  };
  EXPECT_EQ(value(7, 3, 0.5), value(7, 3, 0.5));
  EXPECT_EQ(value(7, 3, 0.5),
            Disturbance(Config(DisturbanceKind::kUniform), 7, 3).At(0.5, SomePlant(9), nullptr));
  EXPECT_NE(value(7, 3, 0.5), value(8, 3, 0.5));
  EXPECT_NE(value(7, 3, 0.5), value(7, 4, 0.5));
  EXPECT_NE(value(7, 3, 0.5), value(7, 3, 0.52));
  EXPECT_NE(value(7, 3, 0.5)[0], value(7, 3, 0.5)[1]);
}

TEST(Disturbance, ConstantAndSineAreWhatTheySay) {
  const PlanarPlant plant = SomePlant();
  const Disturbance constant(Config(DisturbanceKind::kConstant), 1, 1);
  const Disturbance sine(Config(DisturbanceKind::kSine), 1, 1);
  for (const double t_s : {0.0, 0.37, 12.0}) {
    for (size_t i = 0; i < 3; ++i) {
      const double joint = static_cast<double>(i);
      EXPECT_EQ(constant.At(t_s, plant, nullptr)[i], 40.0);
      EXPECT_NEAR(sine.At(t_s, plant, nullptr)[i],
                  40.0 * std::sin(2.0 * std::numbers::pi * (0.5 + 0.2 * joint) * t_s + joint), 1e-9);
    }
  }
  EXPECT_EQ(constant.NextChange(1.0), kInfinity);
  EXPECT_EQ(sine.NextChange(1.0), kInfinity);
}

// d enters (1.1) on the left, so -d is a torque on the arm. Moved by it from rest the end effector must go
// away.
TEST(Disturbance, AdversarialPushesTheEndEffectorAwayFromTheLeader) {
  const LeaderPath leader = SomeLeader();
  const Disturbance disturbance(Config(DisturbanceKind::kAdversarial), 1, 1);
  RandomArms random(2);
  for (int trial = 0; trial < 300; ++trial) {
    const PlanarArm arm(random.Config(1 + trial % kMaxDof));
    PlanarPlant plant(arm.config());
    const JointVector q = random.Numbers(arm.dof(), 3.0);
    plant.q_rad = ToPlant(q);
    const JointVector d_Nm = FromPlant(plant, disturbance.At(0.3, plant, &leader));
    const TaskVector e = arm.Position(arm.At(q)) - leader.At(0.3).x_m;
    const JointVector slope = arm.Jacobian(arm.At(q)).transpose() * e;  // of |e|^2 / 2
    for (int i = 0; i < arm.dof(); ++i) EXPECT_NEAR(-d_Nm[i] * slope[i], 40.0 * std::abs(slope[i]), 1e-9);
  }
}

TEST(Disturbance, AdversarialWithoutALeaderIsNone) {
  const Disturbance disturbance(Config(DisturbanceKind::kAdversarial), 1, 1);
  for (const double d : disturbance.At(0.0, SomePlant(), nullptr)) EXPECT_EQ(d, 0.0);
}

}  // namespace
}  // namespace armada
