#include "firmware/app/feedback_consistency.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace armada {
namespace {

constexpr double kPeriod_s = 0.01;
constexpr FeedbackConsistency::Limits kLimits{
    .travel_max_rad = 0.05, .speed_noise_rad_s = 0.01, .memory_s = 0.1};

double Position(double t_s) {
  return 2.0 * std::sin(3.0 * t_s);
}
double Speed(double t_s) {
  return 6.0 * std::cos(3.0 * t_s);
}

/// Ticks until `read(t, q, dq)` is noticed, from t = 0; `most` if it is not.
template <class Read>
int NoticedAfter(Read read, int most = 1000) {
  FeedbackConsistency consistency(kLimits);
  for (int k = 0; k < most; ++k) {
    const double t_s = k * kPeriod_s;
    double q_rad = Position(t_s);
    double dq_rad_s = Speed(t_s);
    read(t_s, &q_rad, &dq_rad_s);
    if (consistency.Update(q_rad, dq_rad_s, kPeriod_s)) return k;
  }
  return most;
}

TEST(FeedbackConsistency, BelievesAFastJointWithNoise) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 1.0);
  EXPECT_EQ(NoticedAfter(
                [&](double, double* q, double* dq) {
                  *q += 1e-4 * noise(random);
                  *dq += 0.01 * noise(random);
                },
                100'000),
            100'000);
}

TEST(FeedbackConsistency, NoticesASpeedThatIsNotTheJoints) {
  EXPECT_LE(NoticedAfter([](double, double*, double* dq) { *dq = 0.0; }), 2);
  EXPECT_LE(NoticedAfter([](double, double*, double* dq) { *dq += 1.0; }), 8);
  EXPECT_LE(NoticedAfter([](double t_s, double*, double* dq) { *dq = t_s > 1.0 ? Speed(1.0) : *dq; }), 130);
}

TEST(FeedbackConsistency, NoticesAPositionThatJumpsOrStays) {
  EXPECT_LE(NoticedAfter([](double t_s, double* q, double*) { *q += t_s > 1.0 ? 0.06 : 0.0; }), 102);
  EXPECT_LE(NoticedAfter([](double t_s, double* q, double*) { *q = t_s > 1.0 ? Position(1.0) : *q; }), 103);
}

TEST(FeedbackConsistency, OfADriveWithoutASpeedIsNotAsked) {
  FeedbackConsistency consistency({.travel_max_rad = 0.05, .speed_noise_rad_s = 1e6, .memory_s = 0.1});
  for (int k = 0; k < 1000; ++k) ASSERT_FALSE(consistency.Update(Position(k * kPeriod_s), 0.0, kPeriod_s));
}

}  // namespace
}  // namespace armada
