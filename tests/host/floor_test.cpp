// The floor against what is known of it: the gains' optimality, figures of an independent prototype, and that
// it rises with everything that hides or delays what the controller needs to know.

#include "host/floor/floor.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <string>
#include <vector>

#include "hil/joint_sensor.h"
#include "hil/start_state.h"
#include "host/floor/exact_filter.h"
#include "host/floor/exact_tracking.h"
#include "tests/closed_loop/simulate.h"
#include "tests/support/random_arms.h"

namespace armada {
namespace {

using Sets = std::vector<std::string>;

// The paper's arms, shorter than in hil/scenarios: 4 s of window.
ScenarioConfig Paper(Sets sets = {}) {
  sets.insert(sets.begin(), {"seconds=6.0", "window_start_s=2.0"});
  return ScenarioNamed("paper", sets);
}

double FleetFloor_mm(const Sets& sets, uint64_t seed = 1) {
  return Floor(Paper(sets), seed).fleet_rms_m * 1e3;
}

// Cost of de/dt^2 = a held for h = 1 as a quadratic form of (e, de, a): the integral of (e + t de + t^2/2
// a)^2.
Eigen::Matrix3d StageCost() {
  Eigen::Matrix3d cost;
  const double power[3] = {0, 1, 2};
  const double factor[3] = {1.0, 1.0, 0.5};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) cost(i, j) = factor[i] * factor[j] / (power[i] + power[j] + 1.0);
  }
  return cost;
}

TEST(SampledLqr, HasTheKnownGains) {
  const SampledLqr lqr = SampledLqr::Compute();
  EXPECT_NEAR(lqr.k1_h2, 1.492, 5e-4);
  EXPECT_NEAR(lqr.k2_h, 1.728, 5e-4);
}

TEST(SampledLqr, SolvesTheRiccatiEquation) {
  const SampledLqr lqr = SampledLqr::Compute();
  const Eigen::RowVector2d K(lqr.k1_h2, lqr.k2_h);
  Eigen::Matrix<double, 2, 3> next;  // (e, de) at the end from (e, de, a)
  next << 1.0, 1.0, 0.5, 0.0, 1.0, 1.0;
  Eigen::Matrix<double, 3, 2> closed;  // (e, de, a) under a = -K (e, de)
  closed << Eigen::Matrix2d::Identity(), -K;
  // Cost to go of that feedback, by iteration of the Lyapunov equation.
  Eigen::Matrix2d P = Eigen::Matrix2d::Zero();
  for (int i = 0; i < 200; ++i) {
    P = closed.transpose() * (StageCost() + next.transpose() * P * next) * closed;
  }
  // It is the Riccati equation's solution if the feedback is the minimiser for it: no slope along a.
  const Eigen::Matrix3d Q = StageCost() + next.transpose() * P * next;
  const Eigen::RowVector2d slope = Q.row(2) * closed;
  EXPECT_NEAR(slope.norm(), 0.0, 1e-12);
  EXPECT_GT(Q(2, 2), 0.0);
}

TEST(ExactTracking, HitsTheWantedEndVelocityOfAnyArmUnderGravity) {
  const SampledLqr lqr = SampledLqr::Compute();
  constexpr double kPeriod_s = 0.01;
  RandomArms random(3);
  for (int trial = 0; trial < 50; ++trial) {
    const PlanarArmConfig config = random.Config(2 + trial % 3, 9.81);
    const PlanarArm arm(config);
    const JointVector q = JointVector::Constant(arm.dof(), 0.8);
    const JointVector dq = random.Numbers(arm.dof(), 1.0);
    const TaskVector x = arm.Position(arm.At(q));
    const TaskVector v = arm.Jacobian(arm.At(q)) * dq;
    const TaskVector e = random.Numbers<TaskVector>(2, 0.001);
    LeaderConfig standing;
    standing.axes = {{x[0] - e[0], 0.0, 0.0, 0.0}, {x[1] - e[1], 0.0, 0.0, 0.0}};
    const LeaderPath leader(standing);
    DisturbanceConfig none;
    none.kind = DisturbanceKind::kNone;
    MovingArm moving{PlanarPlant(config), HeldDisturbance(Disturbance(none, 1, 1), leader), 0.0};
    moving.plant.q_rad = ToPlant(q);
    moving.plant.dq_rad_s = ToPlant(dq);

    moving.AdvanceTo(kPeriod_s, ExactTracking(config, {}, leader, kPeriod_s).Torque(moving), 0.001);
    const TaskVector v_end = (1.0 - lqr.k2_h) * v - lqr.k1_h2 / kPeriod_s * e;
    const PlanarPlant::Tip tip = moving.plant.EndEffector();
    EXPECT_NEAR(tip.v_m_s[0], v_end[0], 1e-5) << "trial " << trial;
    EXPECT_NEAR(tip.v_m_s[1], v_end[1], 1e-5) << "trial " << trial;
  }
}

/// A two-link arm let swing under a held disturbance, and what the filter makes of noisy readings of it.
class SwingingArm {
 public:
  SwingingArm(const DisturbanceConfig& disturbance, const ExactFilterConfig& config)
      : leader_(Paper().leader),
        truth_(Start(disturbance)),
        filter_(config, Start(Expected(disturbance))),
        noise_(7) {}

  void Tick(double q_noise_rad, double dq_noise_rad_s) {
    JointReadings readings{truth_.plant.q_rad, truth_.plant.dq_rad_s};
    for (size_t i = 0; i < 2; ++i) {
      readings.q_rad[i] += noise_.In(-q_noise_rad, q_noise_rad);
      readings.dq_rad_s[i] += noise_.In(-dq_noise_rad_s, dq_noise_rad_s);
    }
    filter_.Correct(readings);
  }
  void Advance() {
    const double end_s = truth_.t_s + 0.01;
    truth_.AdvanceTo(end_s, torques_, 0.001);
    filter_.AdvanceTo(end_s, torques_, 0.001);
  }
  const MovingArm& truth() const { return truth_; }
  const MovingArm& belief() const { return filter_.belief(); }

 private:
  static DisturbanceConfig Expected(DisturbanceConfig config) {
    config.amplitude_Nm = 0.0;
    return config;
  }
  MovingArm Start(const DisturbanceConfig& config) const {
    MovingArm arm{PlanarPlant(Paper().fleet.arms[0].arm), HeldDisturbance(Disturbance(config, 1, 1), leader_),
                  0.0};
    arm.plant.q_rad = {0.3, 1.2};
    return arm;
  }

  LeaderPath leader_;
  MovingArm truth_;
  ExactFilter filter_;
  DelayedTorques torques_{0.0};
  RandomArms noise_;
};

TEST(ExactFilter, KnowsSpeedMuchBetterThanItsNoisySensor) {
  DisturbanceConfig disturbance;
  const double q_noise_rad = 1e-5;
  const double dq_noise_rad_s = 0.1;
  SwingingArm arm(disturbance,
                  {.q_deviation_rad = {q_noise_rad / std::sqrt(3.0), q_noise_rad / std::sqrt(3.0)},
                   .dq_deviation_rad_s = {dq_noise_rad_s / std::sqrt(3.0), dq_noise_rad_s / std::sqrt(3.0)},
                   .disturbance_Nm = 40.0 / std::sqrt(3.0)});
  double squares = 0.0;
  for (int k = 0; k < 300; ++k) {
    arm.Tick(q_noise_rad, dq_noise_rad_s);
    if (k >= 100) squares += std::pow(arm.belief().plant.dq_rad_s[0] - arm.truth().plant.dq_rad_s[0], 2);
    arm.Advance();
  }
  EXPECT_LT(std::sqrt(squares / 200.0), 0.2 * dq_noise_rad_s / std::sqrt(3.0));
}

TEST(ExactFilter, LearnsADisturbanceThatIsHeldForManyTicks) {
  DisturbanceConfig disturbance;
  disturbance.hold_s = 0.1;
  SwingingArm arm(disturbance, {.q_deviation_rad = {1e-8, 1e-8},
                                .dq_deviation_rad_s = {1e-7, 1e-7},
                                .disturbance_Nm = 40.0 / std::sqrt(3.0)});
  const Disturbance truth(disturbance, 1, 1);
  for (int k = 0; k < 100; ++k) {
    arm.Tick(0.0, 0.0);
    if (k % 10 == 5) {
      const PlanarPlant::Joints d_Nm = truth.At(arm.truth().t_s, arm.truth().plant, nullptr);
      for (size_t i = 0; i < 2; ++i) EXPECT_NEAR(arm.belief().disturbance.deviation_Nm[i], d_Nm[i], 0.5);
    }
    arm.Advance();
  }
}

// Fleet and arms of docs/floor.md: an independent prototype, with disturbances of another generator.
TEST(Floor, IsWhatThePrototypeFound) {
  const std::vector<double> arms_mm = {0.555, 0.821, 0.697, 0.522, 0.577, 0.467, 0.427};
  std::vector<double> squares(arms_mm.size());
  constexpr int kSeeds = 3;
  for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const FloorResult floor = Floor(Paper({"drive.latency_s=0.0"}), seed);
    for (size_t i = 0; i < squares.size(); ++i) squares[i] += std::pow(floor.arms[i].rms_m * 1e3, 2) / kSeeds;
  }
  for (size_t i = 0; i < squares.size(); ++i) EXPECT_NEAR(std::sqrt(squares[i]) / arms_mm[i], 1.0, 0.06);
}

TEST(Floor, RisesWithLatencyAsThePrototypeFound) {
  const struct {
    const char* latency_s;
    double fleet_mm;
  } known[] = {{"0.0", 0.594}, {"0.001", 0.68}, {"0.002", 0.77}, {"0.01", 1.59}};
  for (const auto& [latency_s, fleet_mm] : known) {
    EXPECT_NEAR(FleetFloor_mm({std::string("drive.latency_s=") + latency_s}) / fleet_mm, 1.0, 0.03)
        << latency_s;
  }
}

TEST(Floor, RisesWithCoarserEncodersAndNoisierSpeed) {
  const auto floor_mm = [](const char* counts, const char* noise_rad_s) {
    return FleetFloor_mm({std::string("drive.encoder_counts_per_turn=") + counts,
                          std::string("drive.velocity_noise_rad_s=") + noise_rad_s});
  };
  const double perfect_mm = floor_mm("0", "0.0");
  const double fine_mm = floor_mm("1048576", "0.05");
  const double coarse_mm = floor_mm("65536", "0.05");
  const double coarser_mm = floor_mm("8192", "0.05");
  EXPECT_LT(perfect_mm, fine_mm);
  EXPECT_LT(1.05 * fine_mm, coarse_mm);
  EXPECT_LT(1.2 * coarse_mm, coarser_mm);
  const double quiet_mm = floor_mm("65536", "0.0");
  const double less_noisy_mm = floor_mm("65536", "0.02");
  EXPECT_LT(quiet_mm, less_noisy_mm);
  EXPECT_LT(less_noisy_mm, coarse_mm);
}

TEST(Floor, SeesAnEncoderBehindAGearAsFineAsItIs) {
  ScenarioConfig scenario = Paper({"drive.encoder_counts_per_turn=65536", "drive.velocity_noise_rad_s=0.05"});
  const double direct_m = Floor(scenario, 1).fleet_rms_m;
  scenario.drive.encoder_counts_per_turn = 1024.0;
  for (ArmEntry& arm : scenario.fleet.arms) {
    for (JointDriveConfig& joint : arm.joints) joint.gear_ratio = 64.0;
  }
  EXPECT_NEAR(Floor(scenario, 1).fleet_rms_m / direct_m, 1.0, 1e-3);
  for (JointDriveConfig& joint : scenario.fleet.arms[0].joints) {
    joint.direction = -1.0;
    joint.offset_rad = 0.7;
  }
  EXPECT_NEAR(Floor(scenario, 1).fleet_rms_m / direct_m, 1.0, 0.02);
}

TEST(Floor, IsNextToNothingWhereNothingIsRandom) {
  for (const char* kind : {"none", "constant", "sine", "adversarial"}) {
    EXPECT_LT(FleetFloor_mm({std::string("disturbance.kind=") + kind, "drive.latency_s=0.0"}), 0.003) << kind;
  }
}

TEST(Floor, FallsWhereADisturbanceIsHeldLongEnoughToBeLearnt) {
  EXPECT_LT(FleetFloor_mm({"disturbance.hold_s=0.1"}), 0.5 * FleetFloor_mm({}));
}

TEST(Floor, DependsOnTheSeedAlone) {
  const ScenarioConfig scenario = Paper({"seconds=3.0"});
  EXPECT_EQ(Floor(scenario, 4).fleet_rms_m, Floor(scenario, 4).fleet_rms_m);
  EXPECT_NE(Floor(scenario, 4).fleet_rms_m, Floor(scenario, 5).fleet_rms_m);
}

// Arm 6 can hold its second joint at 1 rad in two ways, and feels the disturbance more in one of them.
TEST(Floor, DependsOnThePostureOfSpareJoints) {
  const ScenarioConfig scenario = Paper({"drive.latency_s=0.0"});
  std::vector<JointVector> postures_rad;
  for (const ArmEntry& entry : scenario.fleet.arms) postures_rad.push_back(BentElbow(PlanarArm(entry.arm)));
  EXPECT_EQ(Floor(scenario, 1, postures_rad).fleet_rms_m, Floor(scenario, 1).fleet_rms_m);
  postures_rad[5] << 1.0, 1.0, -2.5;
  const FloorResult other = Floor(scenario, 1, postures_rad);
  EXPECT_GT(other.arms[5].rms_m, 1.1 * Floor(scenario, 1).arms[5].rms_m);
  EXPECT_EQ(other.arms[0].rms_m, Floor(scenario, 1).arms[0].rms_m);
}

TEST(Floor, IsBelowWhatTheLawReaches) {
  for (const Sets& sets :
       {Sets{"arm.*.control.subtask.kind=none"}, Sets{"drive.latency_s=0.0", "timing.sample_to_torque_s=0.0"},
        Sets{"drive.encoder_counts_per_turn=1048576", "drive.velocity_noise_rad_s=0.02"}}) {
    ScenarioConfig scenario = ScenarioNamed("paper", sets);
    scenario.seconds = 14.0;
    scenario.window_start_s = 10.0;
    RunMetrics run = Simulation(scenario, 1).Run(nullptr);
    run.CompareWithFloor(scenario);
    for (const ArmMetrics& arm : run.arms)
      EXPECT_GT(arm.rms_m, 0.99 * arm.floor_rms_m.value()) << "arm " << arm.id;
    EXPECT_GT(run.fleet_rms_m, run.floor_rms_m.value());
  }
}

}  // namespace
}  // namespace armada
