#include "hil/leader_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "tests/support/limit_malloc.h"

namespace armada {
namespace {

LeaderConfig PaperLeader() {
  LeaderConfig config;
  config.axes = {{1.2, 0.5, 0.5, 0.0}, {1.3, 0.3, 0.5, M_PI / 2}};
  return config;
}

LeaderConfig Waypoints(std::vector<std::vector<double>> points) {
  LeaderConfig config;
  config.kind = LeaderKind::kWaypoints;
  config.waypoints_m = std::move(points);
  return config;
}

LeaderConfig Triangle(bool loop, double dwell_s) {
  LeaderConfig config = Waypoints({{1.0, 1.0}, {1.6, 1.0}, {1.6, 1.1}});
  config.loop = loop;
  config.dwell_s = dwell_s;
  return config;
}

std::vector<LeaderConfig> ManyLeaders() {
  LeaderConfig sines = PaperLeader();
  sines.axes[1].frequency_hz = 0.3;
  sines.axes.push_back({-0.4, 0.2, 1.1, 0.7});
  std::vector<LeaderConfig> leaders = {PaperLeader(), sines, Triangle(true, 0.0), Triangle(true, 0.4),
                                       Triangle(false, 0.4)};
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place_m(-1.0, 1.0);
  std::uniform_real_distribution<double> decades(-1.5, 1.5);
  for (int i = 0; i < 20; ++i) {  // all mixtures of bounds that are reached and bounds that are not
    LeaderConfig config = Waypoints({});
    for (int k = 0; k < 4; ++k)
      config.waypoints_m.push_back({place_m(random), place_m(random), place_m(random)});
    config.speed_m_s = std::pow(10.0, decades(random));
    config.acceleration_m_s2 = std::pow(10.0, decades(random));
    config.jerk_m_s3 = std::pow(10.0, decades(random));
    config.dwell_s = 0.1 * (i % 3);
    leaders.push_back(config);
  }
  return leaders;
}

double Largest(const TaskVector& vector) {
  return vector.cwiseAbs().maxCoeff();
}

TEST(LeaderPath, SineIsThePapersLeader) {
  const LeaderPath path(PaperLeader());
  for (const double t : {-0.3, 0.0, 0.1, 0.77, 12.0}) {
    const Zeta zeta = path.At(t);
    EXPECT_NEAR(zeta.x_m[0], 1.2 + 0.5 * std::sin(M_PI * t), 1e-12);
    EXPECT_NEAR(zeta.x_m[1], 1.3 + 0.3 * std::cos(M_PI * t), 1e-12);
    EXPECT_NEAR(zeta.v_m_s[1], -0.3 * M_PI * std::sin(M_PI * t), 1e-12);
    EXPECT_NEAR(zeta.a_m_s2[0], -0.5 * M_PI * M_PI * std::sin(M_PI * t), 1e-12);
  }
}

TEST(LeaderPath, PapersBoundsAreThoseOfItsSection4) {
  const LeaderBounds bounds = LeaderPath(PaperLeader()).Bounds();
  EXPECT_NEAR(bounds.v_m_s, 1.571, 5e-4);
  EXPECT_NEAR(bounds.a_m_s2, 4.935, 5e-4);
  EXPECT_NEAR(bounds.jerk_m_s3, 15.504, 3e-3);
}

// Simpson's rule is exact within a phase of an SCurve; where a phase ends inside the step, jerk h^2 is the
// error left.
TEST(LeaderPath, PositionIsTheIntegralOfVelocityAndVelocityOfAcceleration) {
  constexpr double h = 1e-4;
  for (const LeaderConfig& config : ManyLeaders()) {
    const LeaderPath path(config);
    const double tolerance = 2.0 * path.Bounds().jerk_m_s3 * h * h + 1e-11;
    for (double t = -0.2; t < std::min(path.period_s(), 20.0) + 0.5; t += 0.01) {
      const Zeta a = path.At(t);
      const Zeta m = path.At(t + 0.5 * h);
      const Zeta b = path.At(t + h);
      const TaskVector dx = h / 6.0 * (a.v_m_s + 4.0 * m.v_m_s + b.v_m_s);
      const TaskVector dv = h / 6.0 * (a.a_m_s2 + 4.0 * m.a_m_s2 + b.a_m_s2);
      ASSERT_LT(Largest(b.x_m - a.x_m - dx), tolerance * h + 1e-14) << "t = " << t;
      ASSERT_LT(Largest(b.v_m_s - a.v_m_s - dv), tolerance) << "t = " << t;
    }
  }
}

TEST(LeaderPath, AccelerationIsContinuousWithTheJerkThatBoundsSays) {
  for (const LeaderConfig& config : ManyLeaders()) {
    const LeaderPath path(config);
    const LeaderBounds bounds = path.Bounds();
    const double end_s = std::min(path.period_s(), 200.0) + 0.3;
    const double h = end_s / 100000;
    double jerk = 0.0;
    TaskVector before = path.At(-h).a_m_s2;
    for (double t = 0.0; t < end_s; t += h) {
      const TaskVector now = path.At(t).a_m_s2;
      jerk = std::max(jerk, Largest(now - before) / h);
      before = now;
    }
    EXPECT_LT(jerk, bounds.jerk_m_s3 * (1.0 + 1e-6) + 1e-6);
    EXPECT_GT(jerk, bounds.jerk_m_s3 * 0.999);
  }
}

// Except where an SCurve's jerk jumps: in few of the intervals.
TEST(LeaderPath, JerkIsTheDerivativeOfAcceleration) {
  constexpr double h = 1e-5;
  for (const LeaderConfig& config : ManyLeaders()) {
    const LeaderPath path(config);
    const LeaderBounds bounds = path.Bounds();
    int samples = 0;
    int jumps = 0;
    for (double t = -0.1; t < std::min(path.period_s(), 20.0) + 0.2; t += 0.00937) {
      const TaskVector slope = (path.At(t + h).a_m_s2 - path.At(t - h).a_m_s2) / (2.0 * h);
      const double off = Largest(slope - path.Jerk(t));
      ++samples;
      jumps += off > 1e-4 * bounds.jerk_m_s3 + 1e-6 ? 1 : 0;
      EXPECT_LE(Largest(path.Jerk(t)), bounds.jerk_m_s3 * (1.0 + 1e-9));
    }
    EXPECT_LE(jumps, std::isfinite(bounds.snap_m_s4) ? 0 : samples / 50 + 1);
  }
}

TEST(LeaderPath, SnapOfThePapersLeaderIsTheFourthDerivative) {
  EXPECT_NEAR(LeaderPath(PaperLeader()).Bounds().snap_m_s4, 0.5 * std::pow(M_PI, 4), 1e-9);
  EXPECT_TRUE(std::isinf(LeaderPath(Triangle(true, 0.0)).Bounds().snap_m_s4));
}

TEST(LeaderPath, BoundsOnSpeedAndAccelerationHoldAndAreAttained) {
  for (const LeaderConfig& config : ManyLeaders()) {
    const LeaderPath path(config);
    const LeaderBounds bounds = path.Bounds();
    const double end_s = std::min(path.period_s(), 200.0);
    double v = 0.0;
    double a = 0.0;
    for (double t = 0.0; t < end_s; t += end_s / 100000) {
      const Zeta zeta = path.At(t);
      v = std::max(v, Largest(zeta.v_m_s));
      a = std::max(a, Largest(zeta.a_m_s2));
    }
    EXPECT_LT(v, bounds.v_m_s * (1.0 + 1e-9));
    EXPECT_GT(v, bounds.v_m_s * 0.998);
    EXPECT_LT(a, bounds.a_m_s2 * (1.0 + 1e-9));
    EXPECT_GT(a, bounds.a_m_s2 * 0.99);
  }
}

TEST(LeaderPath, WaypointsAreMetAtRest) {
  constexpr double kDwell_s = 0.4;
  const LeaderConfig config = Triangle(false, kDwell_s);
  const LeaderPath path(config);
  double t = 0.0;
  for (size_t i = 0; i < 3; ++i) {
    for (const double into_s : {0.0, 0.2, kDwell_s}) {
      const Zeta zeta = path.At(t + into_s);
      EXPECT_NEAR(zeta.x_m[0], config.waypoints_m[i][0], 1e-12);
      EXPECT_NEAR(zeta.x_m[1], config.waypoints_m[i][1], 1e-12);
      EXPECT_NEAR(Largest(zeta.v_m_s), 0.0, 1e-9);
      EXPECT_NEAR(Largest(zeta.a_m_s2), 0.0, 1e-6);
    }
    t += kDwell_s;
    if (i == 2) break;
    const double length_m = i == 0 ? 0.6 : 0.1;
    t += SCurve(length_m, {config.speed_m_s, config.acceleration_m_s2, config.jerk_m_s3}).duration_s();
  }
  EXPECT_NEAR(path.period_s(), t - kDwell_s, 1e-12) << "nothing new comes after the arrival at the last";
  EXPECT_EQ(path.At(1e6).x_m, path.At(t).x_m);
  EXPECT_EQ(path.At(-5.0).x_m, path.At(0.0).x_m);
}

TEST(LeaderPath, WayBetweenWaypointsIsStraight) {
  const LeaderPath path(Waypoints({{0.0, 0.0}, {0.3, 0.4}}));
  for (double t = 0.0; t < path.period_s(); t += 0.01) {
    const Zeta zeta = path.At(t);
    EXPECT_NEAR(zeta.x_m[0] * 0.4, zeta.x_m[1] * 0.3, 1e-14);
    EXPECT_NEAR(zeta.v_m_s[0] * 0.4, zeta.v_m_s[1] * 0.3, 1e-14);
  }
}

TEST(LeaderPath, RepeatsAfterItsPeriodAndNotBefore) {
  LeaderConfig two_sines = PaperLeader();
  two_sines.axes[1].frequency_hz = 0.3;
  const std::array<std::pair<LeaderConfig, double>, 3> cases = {
      {{PaperLeader(), 2.0}, {two_sines, 10.0}, {Triangle(true, 0.4), 0.0}}};
  for (const auto& [config, expected_s] : cases) {
    const LeaderPath path(config);
    const double period_s = path.period_s();
    if (expected_s > 0.0) {
      EXPECT_NEAR(period_s, expected_s, 1e-12);
    }
    double half_differs = 0.0;
    for (double t = 0.0; t < period_s; t += 0.013) {
      EXPECT_LT(Largest(path.At(t + period_s).x_m - path.At(t).x_m), 1e-9);
      EXPECT_LT(Largest(path.At(t + 3 * period_s).a_m_s2 - path.At(t).a_m_s2), 1e-6);
      half_differs = std::max(half_differs, Largest(path.At(t + 0.5 * period_s).x_m - path.At(t).x_m));
    }
    EXPECT_GT(half_differs, 0.1);
  }
}

TEST(LeaderPath, SinesWithoutACommonPeriodSaySo) {
  LeaderConfig config = PaperLeader();
  config.axes[1].frequency_hz = 0.5 * std::sqrt(2.0);
  EXPECT_TRUE(std::isinf(LeaderPath(config).period_s()));
}

TEST(LeaderPath, LeaderAtRestHasNoBoundsAndNoPeriod) {
  LeaderConfig still = PaperLeader();
  still.axes[0].frequency_hz = 0.0;
  still.axes[1].amplitude_m = 0.0;
  for (const LeaderConfig& config : {still, Waypoints({{1.0, 2.0}}), Waypoints({{1.0, 2.0}, {1.0, 2.0}})}) {
    const LeaderPath path(config);
    EXPECT_EQ(path.period_s(), 0.0);
    EXPECT_EQ(path.Bounds().v_m_s, 0.0);
    EXPECT_EQ(path.Bounds().jerk_m_s3, 0.0);
    EXPECT_EQ(path.At(0.3).x_m, path.At(1e9).x_m);
    EXPECT_EQ(Largest(path.At(0.3).v_m_s), 0.0);
  }
}

TEST(LeaderPath, LeaderlessFleetHasBoundsOfZero) {
  LeaderConfig config;
  config.kind = LeaderKind::kNone;
  const LeaderPath path(config);
  EXPECT_EQ(path.Bounds().v_m_s, 0.0);
  EXPECT_EQ(path.period_s(), 0.0);
}

TEST(LeaderPath, EvaluationAllocatesNothing) {
  const LeaderPath sine(PaperLeader());
  const LeaderPath legs(Triangle(true, 0.1));
  double sum = 0.0;
  {
    LimitMalloc guard;
    for (double t = -1.0; t < 10.0; t += 0.01) {
      sum += sine.At(t).x_m[0] + legs.At(t).a_m_s2[1] + sine.Jerk(t)[0] + legs.Jerk(t)[1];
    }
  }
  EXPECT_TRUE(std::isfinite(sum));
}

TEST(SCurve, ReachesEachBoundWhenTheLengthAllowsIt) {
  const SCurveLimits limits{0.5, 2.0, 15.0};
  const SCurve all(1.0, limits);
  EXPECT_DOUBLE_EQ(all.peak_speed_m_s(), 0.5);
  EXPECT_DOUBLE_EQ(all.peak_acceleration_m_s2(), 2.0);
  // V/A + A/J twice, and the rest at V.
  EXPECT_NEAR(all.duration_s(), 1.0 / 0.5 + (0.5 / 2.0 + 2.0 / 15.0), 1e-12);

  const SCurve no_cruise(0.15, limits);
  EXPECT_LT(no_cruise.peak_speed_m_s(), 0.5);
  EXPECT_DOUBLE_EQ(no_cruise.peak_acceleration_m_s2(), 2.0);

  const SCurve jerk_only(0.01, limits);
  EXPECT_LT(jerk_only.peak_acceleration_m_s2(), 2.0);
  EXPECT_NEAR(jerk_only.duration_s(), 4.0 * std::cbrt(0.01 / (2.0 * 15.0)), 1e-12);
}

TEST(SCurve, IsContinuousInItsLengthWhereAPhaseAppears) {
  const SCurveLimits limits{0.5, 2.0, 15.0};
  const double touches_m = 2.0 * 8.0 / 225.0;               // 2 A^3 / J^2
  const double cruises_m = 0.5 * (0.5 / 2.0 + 2.0 / 15.0);  // V (V/A + A/J)
  for (const double length_m : {touches_m, cruises_m}) {
    const SCurve below(length_m - 1e-12, limits);
    const SCurve above(length_m + 1e-12, limits);
    EXPECT_NEAR(below.duration_s(), above.duration_s(), 1e-8);
    EXPECT_NEAR(below.peak_speed_m_s(), above.peak_speed_m_s(), 1e-8);
  }
}

}  // namespace
}  // namespace armada
