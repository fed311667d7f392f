#include "firmware/core/limits.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/numbers.h"
#include "tests/support/random_arms.h"

namespace armada {
namespace {

const JointVector kLimit_Nm{{10.0, 20.0, 30.0}};

TEST(TorqueGate, PassesWhatIsWithinTheLimits) {
  TorqueGate gate(kLimit_Nm);
  for (const JointVector& wanted : {JointVector{{1.0, -2.0, 3.0}}, JointVector{{10.0, -20.0, 30.0}}}) {
    EXPECT_EQ(gate.Update(wanted), wanted);
  }
  EXPECT_EQ(gate.saturated_ticks(), 0);
}

TEST(TorqueGate, NeverSendsMoreThanTheLimitOfAnyJoint) {
  RandomArms random(1);
  TorqueGate gate(kLimit_Nm);
  int saturated = 0;
  for (int k = 0; k < 1000; ++k) {
    const JointVector wanted = random.Numbers(3, 60.0);
    const JointVector sent = gate.Update(wanted);
    EXPECT_TRUE((sent.cwiseAbs().array() <= kLimit_Nm.array()).all());
    for (int i = 0; i < 3; ++i) EXPECT_EQ(sent[i], std::clamp(wanted[i], -kLimit_Nm[i], kLimit_Nm[i]));
    saturated += sent != wanted;
  }
  EXPECT_EQ(gate.saturated_ticks(), saturated);
  EXPECT_GT(saturated, 500);
}

TEST(TorqueGate, SendsZeroInPlaceOfAnyNonFiniteValue) {
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    for (int joint = 0; joint < 3; ++joint) {
      TorqueGate gate(kLimit_Nm);
      JointVector wanted{{1.0, 2.0, 3.0}};
      gate.Update(wanted);
      EXPECT_TRUE(gate.finite());
      wanted[joint] = bad;
      EXPECT_TRUE(gate.Update(wanted).isZero(0.0));
      EXPECT_FALSE(gate.finite());
      EXPECT_EQ(gate.Update(JointVector{{1.0, 2.0, 3.0}}), (JointVector{{1.0, 2.0, 3.0}}));
    }
  }
}

}  // namespace
}  // namespace armada
