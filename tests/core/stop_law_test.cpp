// The laws of HOLD and SAFE_STOP against the plant that no controller shares code with.

#include "firmware/core/stop_law.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/core/paper_setting.h"
#include "tests/support/random_arms.h"

namespace armada {
namespace {

constexpr double kLatency_s = 0.001;

/// An arm under a law without network, its torque in force one millisecond after the sample.
class StoppingArm {
 public:
  StoppingArm(const PlanarArmConfig& config, double torque_limit_Nm)
      : arm_(config), plant_(config), limit_Nm_(torque_limit_Nm), tau_Nm_(JointVector::Zero(config.dof)) {}

  template <class Law>
  void RunFor(double seconds, Law law) {
    for (double t_s = 0.0; t_s < seconds - 1e-9; t_s += kPeriod_s) {
      const StopLawInput in{q(), dq(), theta_hat, kPeriod_s};
      const JointVector next = law(arm_, in).cwiseMax(-limit_Nm_).cwiseMin(limit_Nm_);
      for (int i = 0; i < 10; ++i) {
        const bool old = i * 0.001 < kLatency_s - 1e-9;
        plant_.Step(ToPlant(old ? tau_Nm_ : next), 0.001);
      }
      tau_Nm_ = next;
    }
  }

  JointVector q() const { return FromPlant(plant_, plant_.q_rad); }
  JointVector dq() const { return FromPlant(plant_, plant_.dq_rad_s); }
  double speed_rad_s() const { return dq().cwiseAbs().maxCoeff(); }
  double KineticEnergy_J() const { return 0.5 * dq().dot(arm_.Inertia(arm_.At(q()), arm_.Theta()) * dq()); }
  PlanarPlant& plant() { return plant_; }

  ParameterVector theta_hat;

 private:
  PlanarArm arm_;
  PlanarPlant plant_;
  double limit_Nm_;
  JointVector tau_Nm_;
};

StoppingArm Moving(RandomArms& random, int dof, double gravity_m_s2, double speed_rad_s) {
  const PlanarArmConfig config = random.Config(dof, gravity_m_s2);
  StoppingArm arm(config, 1000.0);
  arm.theta_hat = PlanarArm(config).Theta();
  arm.plant().q_rad = ToPlant(random.Numbers(dof, 2.0));
  arm.plant().dq_rad_s = ToPlant(random.Numbers(dof, speed_rad_s));
  return arm;
}

TEST(HoldLaw, BringsEveryArmToRestAndKeepsItsPosture) {
  RandomArms random(11);
  for (int dof = 1; dof <= kMaxDof; ++dof) {
    for (const double gravity_m_s2 : {0.0, 9.81}) {
      StoppingArm arm = Moving(random, dof, gravity_m_s2, 1.0);
      HoldLaw hold{SupervisorConfig()};
      const JointVector K_s = JointVector::Constant(dof, 100.0);
      const auto law = [&](const PlanarArm& model, const StopLawInput& in) {
        return hold.Torque(model, K_s, in);
      };
      arm.RunFor(0.4, law);
      EXPECT_LT(arm.speed_rad_s(), 0.2) << dof << " joints, gravity " << gravity_m_s2;
      arm.RunFor(1.6, law);
      EXPECT_TRUE(hold.holds_posture());
      EXPECT_LT(arm.speed_rad_s(), 0.01) << dof << " joints, gravity " << gravity_m_s2;
      const JointVector held = arm.q();
      arm.RunFor(2.0, law);
      EXPECT_LT((arm.q() - held).cwiseAbs().maxCoeff(), 5e-3) << dof << " joints, gravity " << gravity_m_s2;
    }
  }
}

// The weight of an arm that is not known: it sags by K_s hold_rate, and stays.
TEST(HoldLaw, HoldsAWeightThatIsNotKnown) {
  RandomArms random(12);
  StoppingArm arm = Moving(random, 3, 9.81, 1.0);
  arm.theta_hat.tail(3).setZero();  // gravity moments
  HoldLaw hold{SupervisorConfig()};
  const JointVector K_s = JointVector::Constant(3, 150.0);
  const auto law = [&](const PlanarArm& model, const StopLawInput& in) {
    return hold.Torque(model, K_s, in);
  };
  arm.RunFor(5.0, law);
  EXPECT_LT(arm.speed_rad_s(), 0.02);
  const JointVector held = arm.q();
  arm.RunFor(2.0, law);
  EXPECT_LT((arm.q() - held).cwiseAbs().maxCoeff(), 0.01);
}

TEST(HoldLaw, ANewHoldTakesANewPosture) {
  RandomArms random(13);
  StoppingArm arm = Moving(random, 2, 0.0, 0.5);
  HoldLaw hold{SupervisorConfig()};
  const JointVector K_s = JointVector::Constant(2, 100.0);
  const auto law = [&](const PlanarArm& model, const StopLawInput& in) {
    return hold.Torque(model, K_s, in);
  };
  arm.RunFor(1.0, law);
  arm.plant().q_rad[0] += 1.0;
  hold.Restart();
  const JointVector moved = arm.q();
  arm.RunFor(1.0, law);
  EXPECT_LT((arm.q() - moved).cwiseAbs().maxCoeff(), 0.02);
}

TEST(DampingTorque, TakesEnergyOutOfEveryArmWhateverIsBelievedOfIt) {
  RandomArms random(14);
  for (int dof = 1; dof <= kMaxDof; ++dof) {
    for (const double scale : {0.1, 1.0, 10.0}) {
      StoppingArm arm = Moving(random, dof, 0.0, 2.0);
      arm.theta_hat *= scale;
      const JointVector K = JointVector::Constant(dof, 50.0);
      const double first_J = arm.KineticEnergy_J();
      double last_J = first_J;
      for (int i = 0; i < 100; ++i) {
        arm.RunFor(0.05, [&](const PlanarArm& model, const StopLawInput& in) {
          return DampingTorque(model, K, in);
        });
        EXPECT_LE(arm.KineticEnergy_J(), last_J + 1e-9) << dof << " joints, scale " << scale;
        last_J = arm.KineticEnergy_J();
      }
      EXPECT_LT(last_J, 0.1 * first_J) << dof << " joints, scale " << scale;
    }
  }
}

TEST(DampingTorque, LeavesOutWhatIsNotANumber) {
  RandomArms random(15);
  const PlanarArm arm(random.Config(3, 9.81));
  StopLawInput in{JointVector::Zero(3), JointVector::Constant(3, 2.0),
                  ParameterVector::Constant(arm.parameter_count(), std::numeric_limits<double>::quiet_NaN()),
                  kPeriod_s};
  EXPECT_EQ(DampingTorque(arm, JointVector::Constant(3, 50.0), in), JointVector::Constant(3, -100.0));
}

}  // namespace
}  // namespace armada
