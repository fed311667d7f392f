// Orocos KDL (Debian: liborocos-kdl-dev), spatial rigid-body algorithms by other authors, judges the planar
// model.
#include <gtest/gtest.h>

#include <kdl/chaindynparam.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <kdl/chainjnttojacdotsolver.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "tests/support/random_arms.h"

namespace armada {
namespace {

// The arm as KDL sees it: a fixed segment for the base, then one segment a link, its frame at the link's far
// end.
KDL::Chain ChainOf(const PlanarArmConfig& config) {
  KDL::Chain chain;
  const KDL::Vector base(config.base_x_m, config.base_y_m, 0.0);
  chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None),
                                KDL::Frame(KDL::Rotation::RotZ(config.base_orientation_rad), base)));
  for (int i = 0; i < config.dof; ++i) {
    const LinkConfig& link = config.links[static_cast<size_t>(i)];
    const KDL::RigidBodyInertia inertia(link.m_kg, KDL::Vector(link.r_m - link.l_m, 0.0, 0.0),
                                        KDL::RotationalInertia(0.0, 0.0, link.I_kgm2));
    chain.addSegment(
        KDL::Segment(KDL::Joint(KDL::Joint::RotZ), KDL::Frame(KDL::Vector(link.l_m, 0.0, 0.0)), inertia));
  }
  return chain;
}

KDL::JntArray ToKdl(const JointVector& values) {
  KDL::JntArray array(static_cast<unsigned>(values.size()));
  array.data = values;
  return array;
}

// A random arm in a random state, as both libraries see it.
struct Case {
  Case(RandomArms& random, const PlanarArm& planar)
      : arm(planar),
        q(random.Numbers(arm.dof(), 5.0)),
        dq(random.Numbers(arm.dof(), 5.0)),
        at(arm.At(q)),
        theta(arm.Theta()),
        chain(ChainOf(arm.config())),
        gravity(0.0, -arm.config().gravity_m_s2, 0.0) {}

  PlanarArm arm;
  JointVector q, dq;
  PlanarArm::Posture at;
  ParameterVector theta;
  KDL::Chain chain;
  KDL::Vector gravity;
};

class KdlOracle : public testing::Test {
 protected:
  template <class Check>
  void ForRandomCases(uint64_t seed, Check check) {
    RandomArms random(seed);
    for (const PlanarArm& arm : random.AllKinds(20)) check(Case(random, arm), random);
  }
};

TEST_F(KdlOracle, AgreesOnPositionAndJacobian) {
  ForRandomCases(1, [](const Case& c, RandomArms&) {
    KDL::Frame tip;
    ASSERT_EQ(KDL::ChainFkSolverPos_recursive(c.chain).JntToCart(ToKdl(c.q), tip), 0);
    EXPECT_NEAR(tip.p.x(), c.arm.Position(c.at)[0], 1e-12);
    EXPECT_NEAR(tip.p.y(), c.arm.Position(c.at)[1], 1e-12);

    KDL::Jacobian J(static_cast<unsigned>(c.arm.dof()));
    ASSERT_EQ(KDL::ChainJntToJacSolver(c.chain).JntToJac(ToKdl(c.q), J), 0);
    EXPECT_LT((J.data.topRows(2) - c.arm.Jacobian(c.at)).cwiseAbs().maxCoeff(), 1e-12);
  });
}

TEST_F(KdlOracle, AgreesOnTheJacobiansRate) {
  ForRandomCases(2, [](const Case& c, RandomArms&) {
    KDL::Jacobian dJ(static_cast<unsigned>(c.arm.dof()));
    ASSERT_EQ(KDL::ChainJntToJacDotSolver(c.chain).JntToJacDot(KDL::JntArrayVel(ToKdl(c.q), ToKdl(c.dq)), dJ),
              0);
    EXPECT_LT((dJ.data.topRows(2) - c.arm.JacobianRate(c.at, c.dq)).cwiseAbs().maxCoeff(), 1e-11);
  });
}

TEST_F(KdlOracle, AgreesOnInertiaCoriolisAndGravity) {
  ForRandomCases(3, [](const Case& c, RandomArms&) {
    const auto n = static_cast<unsigned>(c.arm.dof());
    KDL::ChainDynParam dynamics(c.chain, c.gravity);
    KDL::JntSpaceInertiaMatrix H(c.arm.dof());
    KDL::JntArray C_dq(n), g(n);
    ASSERT_EQ(dynamics.JntToMass(ToKdl(c.q), H), 0);
    ASSERT_EQ(dynamics.JntToCoriolis(ToKdl(c.q), ToKdl(c.dq), C_dq), 0);
    ASSERT_EQ(dynamics.JntToGravity(ToKdl(c.q), g), 0);
    EXPECT_LT((H.data - c.arm.Inertia(c.at, c.theta)).cwiseAbs().maxCoeff(), 1e-10);
    EXPECT_LT((C_dq.data - c.arm.Coriolis(c.at, c.dq, c.theta) * c.dq).cwiseAbs().maxCoeff(), 1e-8);
    EXPECT_LT((g.data - c.arm.Bias(c.at, JointVector::Zero(c.arm.dof()), c.theta)).cwiseAbs().maxCoeff(),
              1e-10);
  });
}

// KDL gives C(q, dq) dq alone; the Christoffel form of C(q, dq) y follows from it by polarisation.
TEST_F(KdlOracle, AgreesOnTheRegressorOfInverseDynamics) {
  ForRandomCases(4, [](const Case& c, RandomArms& random) {
    const auto n = static_cast<unsigned>(c.arm.dof());
    const JointVector y = random.Numbers(c.arm.dof(), 5.0);
    const JointVector x = random.Numbers(c.arm.dof(), 20.0);
    KDL::ChainIdSolver_RNE inverse_dynamics(c.chain, c.gravity);
    const auto torque = [&](const JointVector& speed, const JointVector& acceleration) {
      KDL::JntArray tau(n);
      const KDL::Wrenches none(c.chain.getNrOfSegments(), KDL::Wrench::Zero());
      EXPECT_EQ(inverse_dynamics.CartToJnt(ToKdl(c.q), ToKdl(speed), ToKdl(acceleration), none, tau), 0);
      return JointVector(tau.data);
    };
    const JointVector zero = JointVector::Zero(c.arm.dof());
    const JointVector expected = torque(zero, x) + 0.25 * (torque(c.dq + y, zero) - torque(c.dq - y, zero));
    const JointVector actual = c.arm.Regressor(c.at, c.dq, y, x) * c.theta;
    EXPECT_LT((actual - expected).cwiseAbs().maxCoeff(), 1e-10 * (1.0 + expected.cwiseAbs().maxCoeff()));
  });
}

}  // namespace
}  // namespace armada
