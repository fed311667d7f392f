#include "firmware/core/disturbance_observer.h"

#include <gtest/gtest.h>

namespace armada {
namespace {

TEST(DisturbanceObserver, ConvergesToAConstantDisturbance) {
  DisturbanceObserver observer(DisturbanceObserverConfig{}, 2);
  const JointVector d_Nm{{12.0, -30.0}};
  double error_Nm = d_Nm.norm();
  for (int k = 0; k < 60; ++k) {
    observer.Update(-d_Nm);
    EXPECT_NEAR((observer.d_hat_Nm() - d_Nm).norm(), 0.8 * error_Nm, 1e-9);
    error_Nm *= 0.8;
  }
  EXPECT_LT((observer.d_hat_Nm() - d_Nm).norm(), 1e-4);
}

TEST(DisturbanceObserver, ClaimsNoMoreThanItsBound) {
  const DisturbanceObserverConfig config;
  DisturbanceObserver observer(config, 3);
  for (int k = 0; k < 50; ++k) {
    observer.Update(JointVector{{1000.0, -1000.0, -5.0}});
    EXPECT_LE(observer.d_hat_Nm().cwiseAbs().maxCoeff(), config.bound_Nm);
  }
  EXPECT_EQ(observer.d_hat_Nm()[0], -config.bound_Nm);
  EXPECT_EQ(observer.d_hat_Nm()[1], config.bound_Nm);
  EXPECT_NEAR(observer.d_hat_Nm()[2], 5.0, 1e-3);
  observer.Update(JointVector::Zero(3));  // no wind-up: it leaves the bound at once
  EXPECT_NEAR(observer.d_hat_Nm()[0], -0.8 * config.bound_Nm, 1e-12);
}

TEST(DisturbanceObserver, WithoutGainClaimsNothing) {
  DisturbanceObserver observer({.gain = 0.0, .bound_Nm = 40.0}, 2);
  for (int k = 0; k < 10; ++k) observer.Update(JointVector{{5.0, 5.0}});
  EXPECT_TRUE(observer.d_hat_Nm().isZero());
}

}  // namespace
}  // namespace armada
