// Theorem 2 watched on the law as printed, in the conditions of its proof: its storage function falls but for
// what sampling adds, and the claim ends where its conditions do.

#include <algorithm>
#include <functional>

#include "host/check/margin_check.h"
#include "tests/closed_loop/ideal_arm.h"

namespace armada {
namespace {

constexpr double kFine_s = 1e-4;
constexpr size_t kArm5 = 4;
const std::vector<size_t> kTwoJoints = {0, 1, 2, 3};
const std::vector<size_t> kThreeJoints = {5, 6};
const std::vector<size_t> kAllButArm5 = {0, 1, 2, 3, 5, 6};

/// d(t), which may know s.
using Push = std::function<JointVector(const JointVector& s)>;

/// The worst there is of |d|_2 <= radius: it pumps as much into V as it can.
Push WorstInTheTwoNorm(double radius_Nm) {
  return [=](const JointVector& s) { return JointVector(-radius_Nm * s / std::max(s.norm(), 1e-12)); };
}

/// The worst there is of |d_i| <= amplitude.
Push WorstInEachJoint(double amplitude_Nm) {
  return [=](const JointVector& s) { return JointVector(-amplitude_Nm * s.cwiseSign()); };
}

/// As the paper's: uniform in each joint, held 10 ms.
Push Uniform(double amplitude_Nm, double h_s, uint64_t seed) {
  const auto hold = static_cast<int>(std::lround(0.01 / h_s));
  return [=, random = RandomArms(seed), k = 0, d = JointVector()](const JointVector& s) mutable {
    if (k++ % hold == 0) d = random.Numbers(s.size(), amplitude_Nm);
    return d;
  };
}

const ScenarioConfig& Benign() {
  static const ScenarioConfig kScenario = ScenarioNamed("benign");
  return kScenario;
}

struct Watched {
  double rise_J = 0.0;       ///< largest V less the least before it
  double step_rise_J = 0.0;  ///< the same within a tick
  double s_end_rad_s = 0.0;  ///< largest |s| in the last second
  double e_end_m = 0.0;      ///< largest |x - x_0| in the last second
};

Watched Watch(size_t index, uint64_t seed, double h_s, double seconds, const Push& push) {
  IdealArm arm(Benign(), index, seed, h_s);
  Watched watched;
  double before_J = arm.Storage();
  double least_J = before_J;
  while (arm.time_s() < seconds - 0.5 * h_s) {
    arm.Tick(push(arm.s_rad_s()));
    const double V_J = arm.Storage();
    if (!std::isfinite(V_J)) return {V_J, V_J, V_J, V_J};
    watched.rise_J = std::max(watched.rise_J, V_J - least_J);
    watched.step_rise_J = std::max(watched.step_rise_J, V_J - before_J);
    before_J = V_J;
    least_J = std::min(least_J, V_J);
    if (arm.time_s() < seconds - 1.0) continue;
    watched.s_end_rad_s = std::max(watched.s_end_rad_s, arm.s_rad_s().norm());
    watched.e_end_m = std::max(watched.e_end_m, arm.error_m());
  }
  return watched;
}

// Of 30 to 600 J at the start.
constexpr double kLeftBySampling_J = 3e-3;

TEST(StorageFunction, OfThePrintedLawFallsUnderEveryDisturbanceWithinItsCondition) {
  for (const size_t index : kAllButArm5) {
    EXPECT_LT(Watch(index, 1, kFine_s, 1.5, WorstInTheTwoNorm(60.0)).rise_J, kLeftBySampling_J);
    EXPECT_LT(Watch(index, 2, kFine_s, 1.5, Uniform(40.0, kFine_s, 2)).rise_J, kLeftBySampling_J);
  }
}

// While s is still large; dV/dt jumps with d only.
TEST(StorageFunction, FallsAtTheRateOfTheProof) {
  for (const size_t index : kAllButArm5) {
    IdealArm arm(Benign(), index, 1, kFine_s);
    Push push = Uniform(40.0, kFine_s, 1);
    const double start_J = arm.Storage();
    double fallen_J = 0.0;
    while (arm.time_s() < 0.1) {
      const JointVector d_Nm = push(arm.s_rad_s());
      const double rate_W = arm.StorageRate(d_Nm);
      arm.Tick(d_Nm);
      fallen_J -= 0.5 * kFine_s * (rate_W + arm.StorageRate(d_Nm));
    }
    EXPECT_GT(fallen_J, 1.0) << "arm " << index + 1;
    EXPECT_NEAR(start_J - arm.Storage(), fallen_J, 4e-3 * fallen_J) << "arm " << index + 1;
  }
}

TEST(StorageFunction, RisesWithinATickByTheSquareOfThePeriodOnly) {
  for (const size_t index : kAllButArm5) {
    const auto step_rise_J = [&](double h_s) {
      return Watch(index, 1, h_s, 1.0, Uniform(40.0, h_s, 1)).step_rise_J;
    };
    EXPECT_NEAR(std::log2(step_rise_J(4.0 * kFine_s) / step_rise_J(kFine_s)), 4.0, 0.8)
        << "arm " << index + 1;
  }
}

TEST(StorageFunction, AtThePapersPeriodIsNoLongerOne) {
  double largest_J = 0.0;
  for (const size_t index : kAllButArm5)
    largest_J = std::max(largest_J, Watch(index, 1, 0.01, 10.0, Uniform(40.0, 0.01, 1)).rise_J);
  EXPECT_GT(largest_J, 100.0 * kLeftBySampling_J);
}

TEST(TheoremTwo, ErrorsGoToWhatSamplingLeaves) {
  for (const size_t index : kTwoJoints) {
    const auto e_end_m = [&](double h_s) { return Watch(index, 2, h_s, 4.0, Uniform(40.0, h_s, 2)).e_end_m; };
    const double fine_m = e_end_m(kFine_s);
    EXPECT_LT(fine_m, 0.8e-3) << "arm " << index + 1;
    EXPECT_GT(e_end_m(4.0 * kFine_s), 1.5 * fine_m) << "arm " << index + 1;
  }
  // With three joints theta_hat is farther off and T = 0.1 is slow: the theorem promises no rate.
  for (const size_t index : kThreeJoints) {
    const Watched end = Watch(index, 2, kFine_s, 4.0, Uniform(40.0, kFine_s, 2));
    EXPECT_LT(end.e_end_m, 15e-3) << "arm " << index + 1;
    EXPECT_LT(end.s_end_rad_s, 0.1) << "arm " << index + 1 << ": |e_s| <= |s|";
  }
}

ScenarioConfig DisturbedBy(double amplitude_Nm) {
  return ScenarioNamed("benign", {"disturbance.amplitude_Nm=" + std::to_string(amplitude_Nm)});
}

bool CheckedToHold(double amplitude_Nm, size_t index) {
  const ScenarioConfig scenario = DisturbedBy(amplitude_Nm);
  return CheckDisturbance(scenario.fleet.arms[index], scenario.disturbance).holds();
}

// s'K_r sgn(s) = sum K_ri |s_i| >= sum |d_i| |s_i| already where K_ri >= |d_i|: with diagonal K_r the theorem
// asks in the 2-norm for more than its proof needs.
TEST(KrMargin, MissedInTheTwoNormAloneDoesNoHarm) {
  for (const size_t index : kThreeJoints) {
    EXPECT_FALSE(CheckedToHold(55.0, index)) << "|d|_2 up to 95 N m, K_r = 60 N m";
    EXPECT_LT(Watch(index, 1, kFine_s, 1.5, WorstInEachJoint(55.0)).rise_J, kLeftBySampling_J);
  }
}

TEST(KrMargin, MissedInAJointEndsTheClaim) {
  for (const size_t index : kAllButArm5) {
    EXPECT_TRUE(CheckedToHold(30.0, index));
    EXPECT_FALSE(CheckedToHold(100.0, index));
    const Watched within = Watch(index, 1, 2.0 * kFine_s, 3.0, WorstInEachJoint(30.0));
    const Watched beyond = Watch(index, 1, 2.0 * kFine_s, 3.0, WorstInEachJoint(100.0));
    EXPECT_LT(within.rise_J, kLeftBySampling_J) << "arm " << index + 1;
    EXPECT_GT(beyond.rise_J, 30.0 * kLeftBySampling_J) << "arm " << index + 1;
    EXPECT_GT(beyond.s_end_rad_s, 0.1) << "arm " << index + 1;
    EXPECT_GT(beyond.s_end_rad_s, 2.0 * within.s_end_rad_s) << "arm " << index + 1;
  }
}

// That J# is bounded is assumed (Remark 1), not brought about: the leader passes 16 mm from the edge of arm
// 5's reach, and from some starts s takes it there before it vanishes. No gain is to blame, nor sampling.
TEST(RemarkOne, IsNoPropertyOfArm5) {
  int lost = 0;
  for (uint64_t seed = 1; seed <= 8; ++seed) {
    const Watched end = Watch(kArm5, seed, kFine_s, 2.0, Uniform(40.0, kFine_s, seed));
    if (!(end.rise_J < 1e6)) ++lost;
  }
  EXPECT_GE(lost, 1);
  EXPECT_LT(lost, 8);
}

}  // namespace
}  // namespace armada
