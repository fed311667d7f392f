#include "firmware/core/augmented_filter.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "firmware/core/projection.h"
#include "tests/core/paper_setting.h"
#include "tests/support/random_arms.h"

namespace armada {
namespace {

SensorConfig Sensor(int dof, double position_rad = 1e-5, double velocity_rad_s = 1e-3) {
  return {JointVector::Constant(dof, position_rad), JointVector::Constant(dof, velocity_rad_s)};
}

ParameterMatrix Covariance(const PlanarArm& arm, double deviation) {
  return ParameterMatrix::Identity(arm.parameter_count(), arm.parameter_count()) * (deviation * deviation);
}

JointState StateOf(const PlanarPlant& plant) {
  return {FromPlant(plant, plant.q_rad), FromPlant(plant, plant.dq_rad_s)};
}

// A plant of its own derivation under rich torque, damped so that it does not spin up.
class Bench {
 public:
  Bench(const PlanarArm& arm, RandomArms& random) : random_(random), plant_(arm.config()) {
    plant_.q_rad = ToPlant(random.Numbers(arm.dof(), 3.0));
    plant_.dq_rad_s = ToPlant(random.Numbers(arm.dof(), 2.0));
  }

  /// A tick under a torque drawn at random, disturbed by `d_Nm`; returns the torque without it.
  JointVector Advance(const JointVector& d_Nm) {
    const JointVector tau_Nm =
        random_.Numbers(plant_.dof(), 100.0) - 5.0 * FromPlant(plant_, plant_.dq_rad_s);
    for (int i = 0; i < 10; ++i) plant_.Step(ToPlant(tau_Nm - d_Nm), kPeriod_s / 10);
    return tau_Nm;
  }
  JointVector Advance() { return Advance(JointVector::Zero(plant_.dof())); }
  JointState state() const { return StateOf(plant_); }

 private:
  RandomArms& random_;
  PlanarPlant plant_;
};

TEST(AugmentedFilter, KnowsTheJointsFromTheModelWhereSamplesAreWorthNothing) {
  RandomArms random(1);
  for (const PlanarArm& arm : random.AllKinds(1)) {
    if (arm.dof() > 4) continue;
    Bench bench(arm, random);
    AugmentedFilter filter(Sensor(arm.dof(), 1.0, 1e6), {.drift_Nm = 0.0}, {.drift_variance = 0.0},
                           Covariance(arm, 0.0), arm);
    filter.Start(bench.state());
    ParameterVector theta_hat = arm.Theta();
    for (int k = 0; k < 10; ++k) {
      const JointVector tau_Nm = bench.Advance();
      JointState useless = bench.state();
      useless.dq_rad_s.array() += 10.0;
      filter.Update(arm, {tau_Nm, 0.0, tau_Nm}, useless, kPeriod_s, theta_hat);
    }
    EXPECT_LT((filter.joints().q_rad - bench.state().q_rad).norm(), 1e-3) << arm.dof();
    EXPECT_EQ(theta_hat, arm.Theta());
  }
}

// The torque changes within the interval: two halves of the plant's motion, one update.
TEST(AugmentedFilter, PredictsAcrossTheChangeOfTorque) {
  RandomArms random(2);
  const PlanarArm arm(PaperArm(6));
  PlanarPlant plant(arm.config());
  plant.q_rad = {0.3, 1.2, 0.5};
  AugmentedFilter filter(Sensor(3, 1.0, 1e6), {.drift_Nm = 0.0}, {.drift_variance = 0.0},
                         Covariance(arm, 0.0), arm);
  filter.Start(StateOf(plant));
  const JointVector before_Nm = random.Numbers(3, 200.0);
  const JointVector after_Nm = random.Numbers(3, 200.0);
  for (int i = 0; i < 10; ++i) plant.Step(ToPlant(i < 3 ? before_Nm : after_Nm), 0.001);
  ParameterVector theta_hat = arm.Theta();
  filter.Update(arm, {before_Nm, 0.003, after_Nm}, StateOf(plant), kPeriod_s, theta_hat);
  EXPECT_LT((filter.joints().dq_rad_s - StateOf(plant).dq_rad_s).norm(), 1e-7);
}

// Against the textbook filter on the whole state, with every matrix written out.
TEST(AugmentedFilter, IsTheExtendedKalmanFilter) {
  RandomArms random(3);
  for (const PlanarArm& arm : random.AllKinds(1)) {
    const Eigen::Index n = arm.dof();
    const Eigen::Index p = arm.parameter_count();
    const Eigen::Index size = 3 * n + p;
    const SensorConfig sensor = Sensor(arm.dof(), 1e-3, 0.05);
    const DisturbanceModelConfig model;
    constexpr double kThetaDrift = 1e-4;
    AugmentedFilter filter(sensor, model, {.drift_variance = kThetaDrift}, Covariance(arm, 0.3), arm);
    Bench bench(arm, random);
    filter.Start(bench.state());
    ParameterVector theta_hat = arm.Theta();
    Project({.inertia_min_kgm2 = 0.1}, arm, theta_hat);

    Eigen::VectorXd x(size);  // q, dq, theta, d
    x << bench.state().q_rad, bench.state().dq_rad_s, theta_hat, Eigen::VectorXd::Zero(n);
    Eigen::MatrixXd P = Eigen::MatrixXd::Zero(size, size);
    P.diagonal().head(n) = sensor.position_deviation_rad.cwiseAbs2();
    P.diagonal().segment(n, n) = sensor.velocity_deviation_rad_s.cwiseAbs2();
    P.diagonal().segment(2 * n, p).setConstant(0.09);
    P.diagonal().tail(n).setConstant(model.bound_Nm * model.bound_Nm / 3.0);
    for (int k = 0; k < 3; ++k) {
      const JointVector tau_Nm = bench.Advance(random.Numbers(n, 10.0));
      const JointState sample = bench.state();
      const JointState predicted =
          Integrate(arm, theta_hat, {x.head(n), x.segment(n, n)}, tau_Nm - JointVector(x.tail(n)), kPeriod_s);
      const JointVector dq_mid = 0.5 * (x.segment(n, n) + predicted.dq_rad_s);
      const PlanarArm::Posture at = arm.At(0.5 * (x.head(n) + predicted.q_rad));
      const auto Y_at = [&](const JointVector& dq_end) {
        return Eigen::MatrixXd(arm.Regressor(at, dq_mid, dq_mid, (dq_end - x.segment(n, n)) / kPeriod_s));
      };
      const Eigen::MatrixXd Y = Y_at(predicted.dq_rad_s);
      const Eigen::MatrixXd H_inverse = Eigen::MatrixXd(arm.Inertia(at, theta_hat)).inverse();
      Eigen::MatrixXd L(2 * n, n);
      L << 0.5 * kPeriod_s * Eigen::MatrixXd::Identity(n, n), Eigen::MatrixXd::Identity(n, n);
      Eigen::MatrixXd YI(n, p + n);
      YI << Y, Eigen::MatrixXd::Identity(n, n);
      const Eigen::MatrixXd B = -kPeriod_s * H_inverse * YI;
      Eigen::MatrixXd A = Eigen::MatrixXd::Identity(size, size);
      A.block(0, n, n, n) = kPeriod_s * Eigen::MatrixXd::Identity(n, n);
      A.block(0, 2 * n, 2 * n, p + n) = L * B;
      const Eigen::MatrixXd P_b = P.bottomRightCorner(p + n, p + n);
      const Eigen::MatrixXd unforeseen = kPeriod_s * H_inverse * (Y_at(sample.dq_rad_s) - Y);
      const Eigen::MatrixXd noise =
          kPeriod_s * kPeriod_s * model.fast_deviation_Nm * model.fast_deviation_Nm * H_inverse * H_inverse +
          unforeseen * P.block(2 * n, 2 * n, p, p) * unforeseen.transpose();
      Eigen::MatrixXd Q = Eigen::MatrixXd::Zero(size, size);
      Q.topLeftCorner(2 * n, 2 * n) = L * noise * L.transpose();
      Q.topLeftCorner(n, n) += model.roughness * model.roughness / 12.0 * kPeriod_s * kPeriod_s *
                               (noise + B * P_b * B.transpose());
      Q.diagonal().segment(2 * n, p).setConstant(kThetaDrift);
      Q.diagonal().tail(n).setConstant(model.drift_Nm * model.drift_Nm);
      P = A * P * A.transpose() + Q;

      const Eigen::MatrixXd C = Eigen::MatrixXd::Identity(2 * n, size);
      Eigen::MatrixXd S = C * P * C.transpose();
      S.diagonal().head(n) += sensor.position_deviation_rad.cwiseAbs2();
      S.diagonal().tail(n) += sensor.velocity_deviation_rad_s.cwiseAbs2();
      const Eigen::MatrixXd K = P * C.transpose() * S.inverse();
      Eigen::VectorXd y(2 * n);
      y << sample.q_rad - predicted.q_rad, sample.dq_rad_s - predicted.dq_rad_s;
      x.head(n) = predicted.q_rad;
      x.segment(n, n) = predicted.dq_rad_s;
      x += K * y;
      P = (Eigen::MatrixXd::Identity(size, size) - K * C) * P;

      filter.Update(arm, {tau_Nm, 0.0, tau_Nm}, sample, kPeriod_s, theta_hat);
      ASSERT_LT((filter.joints().q_rad - x.head(n)).norm(), 1e-7);
      ASSERT_LT((filter.joints().dq_rad_s - x.segment(n, n)).norm(), 1e-6);
      ASSERT_LT((theta_hat - x.segment(2 * n, p)).norm(), 1e-6 * (1.0 + theta_hat.norm()));
      ASSERT_LT((filter.d_hat_Nm() - x.tail(n)).norm(), 1e-5);
      ASSERT_LT((filter.P_theta() - P.block(2 * n, 2 * n, p, p)).norm(), 1e-7);
    }
  }
}

TEST(AugmentedFilter, FindsTheParametersOfThePapersArms) {
  RandomArms random(4);
  for (int id = 1; id <= 7; ++id) {
    for (const double gravity_m_s2 : {0.0, 9.81}) {
      PlanarArmConfig config = PaperArm(id);
      config.gravity_m_s2 = gravity_m_s2;
      const PlanarArm arm(config);
      Bench bench(arm, random);
      AugmentedFilter filter(Sensor(arm.dof()), {.fast_deviation_Nm = 1.0, .drift_Nm = 0.0}, {},
                             Covariance(arm, 3.0), arm);
      filter.Start(bench.state());
      ParameterVector theta_hat = ParameterVector::Constant(arm.parameter_count(), 3.0);
      Project({}, arm, theta_hat);
      for (int k = 0; k < 1000; ++k) {
        const JointVector tau_Nm = bench.Advance();
        filter.Update(arm, {tau_Nm, 0.0, tau_Nm}, bench.state(), kPeriod_s, theta_hat);
        Project({}, arm, theta_hat);
      }
      EXPECT_LT((theta_hat - arm.Theta()).norm(), 0.01 * arm.Theta().norm())
          << "arm " << id << ", gravity " << gravity_m_s2;
    }
  }
}

// From the paper's start, theta_hat in [0, 5] and 40 N m of disturbance, the error must stay what P says: an
// estimate that is sure of a wrong value takes minutes to mend.
TEST(AugmentedFilter, IsNotSureOfWrongParameters) {
  RandomArms random(5);
  const PlanarArm arm(PaperArm(5));
  double sum = 0.0;
  constexpr int kRuns = 100;
  for (int run = 0; run < kRuns; ++run) {
    Bench bench(arm, random);
    AugmentedFilter filter(Sensor(2), {.drift_Nm = 0.0}, {.drift_variance = 0.0}, Covariance(arm, 3.0), arm);
    filter.Start(bench.state());
    ParameterVector theta_hat = random.Numbers<ParameterVector>(3, 2.5).array() + 2.5;
    Project({}, arm, theta_hat);
    for (int k = 0; k < 200; ++k) {
      const JointVector tau_Nm = bench.Advance(random.Numbers(2, 40.0));
      filter.Update(arm, {tau_Nm, 0.0, tau_Nm}, bench.state(), kPeriod_s, theta_hat);
      Project({}, arm, theta_hat);
    }
    const Eigen::Vector3d error = theta_hat - arm.Theta();
    sum += error.dot(Eigen::Matrix3d(filter.P_theta()).inverse() * error) / 3.0;
  }
  EXPECT_LT(sum / kRuns, 8.0);  // 1 where P is exact; 500 without the second-order term
}

TEST(AugmentedFilter, CovarianceStaysSymmetricAndPositiveDefinite) {
  RandomArms random(6);
  for (const PlanarArm& arm : random.AllKinds(1)) {
    Bench bench(arm, random);
    AugmentedFilter filter(Sensor(arm.dof()), {}, {}, Covariance(arm, 3.0), arm);
    filter.Start(bench.state());
    ParameterVector theta_hat = arm.Theta();
    Project({}, arm, theta_hat);
    for (int k = 0; k < 200; ++k) {
      const JointVector tau_Nm = bench.Advance();
      filter.Update(arm, {tau_Nm, 0.0, tau_Nm}, bench.state(), kPeriod_s, theta_hat);
      Project({}, arm, theta_hat);
      const ParameterMatrix P = filter.P_theta();
      ASSERT_EQ((P - P.transpose()).cwiseAbs().maxCoeff(), 0.0);
    }
    EXPECT_GT(Eigen::MatrixXd(filter.P_theta()).selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(),
              0.0);
  }
}

class DisturbanceTest : public testing::Test {
 protected:
  // d_hat after `seconds` of a constant disturbance on a known arm.
  static JointVector Estimate(const DisturbanceModelConfig& model, const JointVector& d_Nm, double seconds) {
    RandomArms random(7);
    const PlanarArm arm(PaperArm(6));
    Bench bench(arm, random);
    AugmentedFilter filter(Sensor(3), model, {.drift_variance = 0.0}, Covariance(arm, 0.0), arm);
    filter.Start(bench.state());
    ParameterVector theta_hat = arm.Theta();
    for (int k = 0; k < std::lround(seconds / kPeriod_s); ++k) {
      const JointVector tau_Nm = bench.Advance(d_Nm);
      filter.Update(arm, {tau_Nm, 0.0, tau_Nm}, bench.state(), kPeriod_s, theta_hat);
    }
    return filter.d_hat_Nm();
  }
};

TEST_F(DisturbanceTest, AConstantOneIsFound) {
  const JointVector d_Nm{{30.0, -20.0, 10.0}};
  EXPECT_LT((Estimate({}, d_Nm, 2.0) - d_Nm).norm(), 0.5);
}

TEST_F(DisturbanceTest, NoMoreThanTheBoundIsClaimed) {
  const JointVector d_hat_Nm = Estimate({}, JointVector{{70.0, -70.0, 10.0}}, 3.0);
  EXPECT_EQ(d_hat_Nm[0], 40.0);
  EXPECT_EQ(d_hat_Nm[1], -40.0);
}

TEST_F(DisturbanceTest, WithoutDriftNoneIsClaimed) {
  EXPECT_TRUE(Estimate({.drift_Nm = 0.0}, JointVector{{30.0, -20.0, 10.0}}, 1.0).isZero(0.0));
}

// A 16-bit encoder and no velocity from the drive: the model bridges what differencing would amplify.
TEST(AugmentedFilter, FindsTheSpeedFromQuantisedPositions) {
  RandomArms random(8);
  const PlanarArm arm(PaperArm(4));
  const double step_rad = 2.0 * std::numbers::pi / 65536.0;
  Bench bench(arm, random);
  AugmentedFilter filter(Sensor(2, step_rad / std::sqrt(12.0), 1e3), {}, {.drift_variance = 0.0},
                         Covariance(arm, 0.0), arm);
  filter.Start(bench.state());
  ParameterVector theta_hat = arm.Theta();
  double filtered = 0.0;
  double differenced = 0.0;
  JointVector previous = bench.state().q_rad;
  for (int k = 0; k < 500; ++k) {
    const JointVector tau_Nm = bench.Advance(random.Numbers(2, 40.0));
    JointState sample{bench.state().q_rad, JointVector::Zero(2)};
    for (double& q : sample.q_rad) q = std::round(q / step_rad) * step_rad;
    filter.Update(arm, {tau_Nm, 0.0, tau_Nm}, sample, kPeriod_s, theta_hat);
    filtered += (filter.joints().dq_rad_s - bench.state().dq_rad_s).squaredNorm();
    differenced += ((sample.q_rad - previous) / kPeriod_s - bench.state().dq_rad_s).squaredNorm();
    previous = sample.q_rad;
  }
  EXPECT_LT(std::sqrt(filtered / 1000.0), 0.02);
  EXPECT_LT(filtered, 0.05 * differenced);
}

}  // namespace
}  // namespace armada
