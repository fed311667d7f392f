#include "hil/emulated_arm.h"

#include <gtest/gtest.h>

#include <cmath>

#include "firmware/can/odrive_messages.h"
#include "tests/support/random_arms.h"

namespace armada {
namespace {

// `dof` links of 2 kg m^2 about their own joint, without gravity or disturbance, drives that never time out.
ScenarioConfig Scenario(int dof = 1) {
  ScenarioConfig scenario;
  ArmEntry entry;
  entry.id = 4;
  entry.arm.dof = dof;
  for (int i = 0; i < dof; ++i) {
    entry.arm.links[static_cast<size_t>(i)] = {2.0, 1.0, 0.5, 1.5};
    entry.joints.push_back({.node_id = i, .torque_limit_Nm = 100.0});
  }
  scenario.fleet.arms = {entry};
  scenario.disturbance.kind = DisturbanceKind::kNone;
  scenario.drive.watchdog_s = 0.0;
  return scenario;
}

class Bench {
 public:
  explicit Bench(const ScenarioConfig& scenario, const ArmStart& start = {}, double start_s = -0.5,
                 uint64_t seed = 1, const LeaderPath* leader = nullptr)
      : dof_(scenario.fleet.arms[0].arm.dof), arm_(scenario, 0, seed, start, leader, start_s) {}

  EmulatedArm& arm() { return arm_; }

  void AdvanceTo(double t_s) {
    arm_.AdvanceTo(t_s, &out_);
    sent_ += out_.size();
    out_.Clear();
  }
  void Send(double t_s, const CanFrame& frame) {
    arm_.OnFrame(t_s, frame, &out_);
    sent_ += out_.size();
    out_.Clear();
  }
  void Enable(double t_s, int node) {
    Send(t_s, odrive::EncodeSetControllerMode(
                  node, {odrive::ControlMode::kTorque, odrive::InputMode::kPassthrough}));
    Send(t_s, odrive::EncodeSetAxisState(node, odrive::AxisState::kClosedLoop));
  }
  void EnableAll(double t_s) {
    for (int node = 0; node < dof_; ++node) Enable(t_s, node);
  }
  void Torque(double t_s, int node, float tau_Nm) { Send(t_s, odrive::EncodeSetInputTorque(node, tau_Nm)); }
  size_t sent() const { return sent_; }

 private:
  int dof_;
  EmulatedArm arm_;
  FrameList out_;
  size_t sent_ = 0;
};

ArmStart MovingStart() {
  ArmStart start;
  start.q_rad = {0.5, -0.4};
  start.dq_rad_s = {1.0, 2.0};
  return start;
}

TEST(EmulatedArm, StandsOnItsBrakesUntilEveryDriveIsEnabled) {
  Bench bench(Scenario(2), MovingStart());
  bench.Enable(-0.4, 0);
  bench.AdvanceTo(0.2);
  EXPECT_FALSE(bench.arm().released());
  EXPECT_EQ(bench.arm().plant().q_rad, MovingStart().q_rad);
  EXPECT_EQ(bench.arm().plant().dq_rad_s, PlanarPlant::Joints{});
  bench.Enable(0.3, 1);
  bench.AdvanceTo(0.3005);
  EXPECT_TRUE(bench.arm().released());
  EXPECT_NEAR(bench.arm().plant().dq_rad_s[0], 1.0, 1e-2);
  EXPECT_NE(bench.arm().plant().q_rad, MovingStart().q_rad);
}

TEST(EmulatedArm, TellsWhenEachDrivesPowerCameOnAndWentOff) {
  ScenarioConfig scenario = Scenario(2);
  scenario.drive.watchdog_s = 0.03;
  Bench bench(scenario);
  bench.Send(-0.4795, odrive::EncodeClearErrors(0));
  bench.Enable(-0.4795, 0);
  bench.Torque(-0.4611234, 0, 1.0f);
  bench.AdvanceTo(0.1);
  ASSERT_EQ(bench.arm().power().size(), 2u);
  EXPECT_NEAR(bench.arm().power()[0].on_s.value(), -0.4795, 1e-9);
  EXPECT_NEAR(bench.arm().power()[0].off_s.value(), -0.4311234, 1e-9)
      << "by its watchdog, not to the millisecond";
  EXPECT_FALSE(bench.arm().power()[1].on_s || bench.arm().power()[1].off_s) << "it was never on";
}

TEST(EmulatedArm, EnabledEarlyIsLetGoAtTimeZero) {
  Bench bench(Scenario(2), MovingStart());
  bench.EnableAll(-0.4);
  bench.AdvanceTo(-1e-6);
  EXPECT_FALSE(bench.arm().released());
  EXPECT_EQ(bench.arm().plant().q_rad, MovingStart().q_rad);
  bench.AdvanceTo(0.01);
  EXPECT_TRUE(bench.arm().released());
  EXPECT_NEAR(bench.arm().plant().q_rad[0], 0.5 + 0.01 * 1.0, 1e-3);
}

// Constant torque on 2 kg m^2 gives speed tau / 2 (t - onset): the speed tells the onset to rounding.
TEST(EmulatedArm, TorqueActsExactlyOneLatencyAfterItsFrame) {
  for (const double latency_s : {0.0, 0.001, 0.00137, 0.0125}) {
    for (const double sent_s : {0.02, 0.0203333, 0.0999999}) {
      ScenarioConfig scenario = Scenario();
      scenario.drive.latency_s = latency_s;
      Bench bench(scenario);
      bench.EnableAll(-0.4);
      bench.Torque(sent_s, 0, 8.0f);
      bench.AdvanceTo(0.2);
      EXPECT_NEAR(bench.arm().plant().dq_rad_s[0], 4.0 * (0.2 - sent_s - latency_s), 1e-8);
      EXPECT_EQ(bench.arm().Torque()[0], 8.0);
    }
  }
}

TEST(EmulatedArm, EveryTorqueOfATrainActsForItsTime) {
  ScenarioConfig scenario = Scenario();
  scenario.drive.latency_s = 0.0034;
  Bench bench(scenario);
  bench.EnableAll(-0.4);
  RandomArms random(1);
  double t_s = 0.0;
  double expected = 0.0;
  float in_force_Nm = 0.0f;
  double since_s = 0.0;
  for (int k = 0; k < 200; ++k) {
    t_s += random.In(0.0015, 0.012);
    const auto tau_Nm = static_cast<float>(random.In(-50.0, 50.0));
    bench.Torque(t_s, 0, tau_Nm);
    expected += static_cast<double>(in_force_Nm) * (t_s + 0.0034 - since_s) / 2.0;
    in_force_Nm = tau_Nm;
    since_s = t_s + 0.0034;
  }
  bench.AdvanceTo(since_s);
  EXPECT_NEAR(bench.arm().plant().dq_rad_s[0], expected, 1e-6);
}

TEST(EmulatedArm, DisturbanceIsSubtractedFromTheTorque) {
  ScenarioConfig scenario = Scenario();
  scenario.disturbance.kind = DisturbanceKind::kConstant;
  scenario.disturbance.amplitude_Nm = 6.0;
  Bench bench(scenario);
  bench.EnableAll(-0.4);
  bench.AdvanceTo(0.1);
  EXPECT_NEAR(bench.arm().plant().dq_rad_s[0], -6.0 / 2.0 * 0.1, 1e-9);
}

// The held values integrate to the sum over their intervals, however time is cut into calls.
TEST(EmulatedArm, HeldDisturbanceActsOverItsIntervals) {
  ScenarioConfig scenario = Scenario();
  scenario.disturbance.kind = DisturbanceKind::kUniform;
  scenario.disturbance.hold_s = 0.0033;
  Bench bench(scenario);
  bench.EnableAll(-0.4);
  RandomArms random(2);
  double t_s = 0.0;
  while (t_s < 0.33) bench.AdvanceTo(t_s = std::min(0.33, t_s + random.In(1e-5, 0.02)));
  const Disturbance disturbance(scenario.disturbance, 1, 4);
  double expected = 0.0;
  for (int k = 0; k < 100; ++k) {
    expected -= 0.0033 * disturbance.At(0.0033 * (k + 0.5), bench.arm().plant(), nullptr)[0] / 2.0;
  }
  EXPECT_NEAR(bench.arm().plant().dq_rad_s[0], expected, 1e-6);
}

// Away from a leader at (1, 0): clockwise from q < 0, and so on to the end of the hold although q has passed
// 0 by then.
TEST(EmulatedArm, AdversarialDisturbanceIsHeldToo) {
  ScenarioConfig scenario = Scenario();
  scenario.disturbance = {DisturbanceKind::kAdversarial, 6.0, 0.05, 0.0};
  scenario.leader.axes = {{1.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.0, 0.0}};
  const LeaderPath leader(scenario.leader);
  ArmStart start;
  start.q_rad[0] = -0.01;
  start.dq_rad_s[0] = 1.0;
  Bench bench(scenario, start, -0.5, 1, &leader);
  bench.EnableAll(-0.4);
  bench.AdvanceTo(0.05);
  EXPECT_GT(bench.arm().plant().q_rad[0], 0.0);
  EXPECT_NEAR(bench.arm().plant().dq_rad_s[0], 1.0 - 3.0 * 0.05, 1e-9);
  bench.AdvanceTo(0.1);
  EXPECT_NEAR(bench.arm().plant().dq_rad_s[0], 1.0, 1e-9);
}

TEST(EmulatedArm, FreezesWhenItsSpeedLeavesEveryBound) {
  ScenarioConfig scenario = Scenario();
  scenario.plant.diverged_rad_s = 5.0;
  Bench bench(scenario);
  bench.EnableAll(-0.4);
  bench.Torque(0.0, 0, 100.0f);  // 50 rad/s^2
  bench.AdvanceTo(0.08);
  EXPECT_FALSE(bench.arm().diverged());
  bench.AdvanceTo(0.2);
  EXPECT_TRUE(bench.arm().diverged());
  EXPECT_FALSE(bench.arm().released());
  const PlanarPlant::Joints frozen = bench.arm().plant().q_rad;
  EXPECT_NEAR(frozen[0], 0.5 * 50.0 * 0.1 * 0.1, 0.01);
  EXPECT_EQ(bench.arm().plant().dq_rad_s, PlanarPlant::Joints{});
  bench.EnableAll(0.3);
  bench.AdvanceTo(0.5);
  EXPECT_EQ(bench.arm().plant().q_rad, frozen);
}

TEST(EmulatedArm, FreezesOnASpeedThatIsNoNumber) {
  ScenarioConfig scenario = Scenario();
  ArmStart start;
  start.dq_rad_s[0] = std::nan("");
  Bench bench(scenario, start);
  bench.EnableAll(-0.4);
  bench.AdvanceTo(0.01);
  EXPECT_TRUE(bench.arm().diverged());
}

TEST(EmulatedArm, DrivesSendTheirHeartbeatsOnTime) {
  ScenarioConfig scenario = Scenario(2);
  scenario.drive.feedback_period_s = 0.01;
  Bench bench(scenario);
  for (int k = -49; k <= 50; ++k) bench.AdvanceTo(0.01 * k - 0.0001);  // 0.9999 s since power-up, from 0 on
  EXPECT_EQ(bench.sent(), 2u * (10u + 100u));
}

TEST(EmulatedArm, SilenceDisarmsTheDriveAtItsWatchdogsTime) {
  ScenarioConfig scenario = Scenario();
  scenario.drive.watchdog_s = 0.03;
  scenario.drive.latency_s = 0.0;
  Bench bench(scenario, {}, 0.0);
  bench.EnableAll(0.0);
  bench.Torque(0.01, 0, 8.0f);
  bench.AdvanceTo(0.1);
  EXPECT_EQ(bench.arm().Torque()[0], 0.0);
  EXPECT_NEAR(bench.arm().plant().dq_rad_s[0], 4.0 * 0.03, 1e-8);
  bench.AdvanceTo(0.2);
  EXPECT_EQ(bench.arm().plant().dq_rad_s[0], 0.0) << "with all drives off the brakes close";
  EXPECT_FALSE(bench.arm().released());
}

// Times that are not multiples of anything, ends of holds, drives' events and tiny steps: time must always
// move on.
TEST(EmulatedArm, TimeMovesOnThroughAwkwardInstants) {
  for (const double start_s : {-0.5, -0.3000000001, -1.0 / 3.0}) {
    for (const double hold_s : {0.01, 1e-4, 0.0007, 1.0 / 3.0}) {
      ScenarioConfig scenario = Scenario();
      scenario.disturbance.kind = DisturbanceKind::kUniform;
      scenario.disturbance.hold_s = hold_s;
      scenario.drive.feedback_period_s = 0.0123456789;
      Bench bench(scenario, {}, start_s);
      bench.EnableAll(start_s + 0.1);
      double t_s = start_s + 0.1;
      for (const double step_s : {1e-12, 1e-10, 1e-9, 2e-9, 0.1, 1e-17, 0.3, 1.0 / 7.0, 0.0}) {
        t_s += step_s;
        bench.AdvanceTo(t_s);
        EXPECT_NEAR(bench.arm().time_s(), t_s, 1e-12);
        bench.AdvanceTo(t_s - 0.05);  // the past changes nothing
        EXPECT_NEAR(bench.arm().time_s(), t_s, 1e-12);
      }
      const double hold_end_s = std::ceil(t_s / hold_s + 1.0) * hold_s;
      for (const double edge_s :
           {std::nextafter(hold_end_s, 0.0), hold_end_s, std::nextafter(hold_end_s, 10.0)}) {
        bench.AdvanceTo(edge_s);
        EXPECT_NEAR(bench.arm().time_s(), edge_s, 1e-12);
      }
    }
  }
}

TEST(EmulatedArm, SameSeedSameMotion) {
  const auto end = [](uint64_t seed) {
    ScenarioConfig scenario = Scenario(3);
    scenario.disturbance.kind = DisturbanceKind::kUniform;
    Bench bench(scenario, MovingStart(), -0.5, seed);
    bench.EnableAll(-0.4);
    bench.Torque(0.05, 1, 20.0f);
    bench.AdvanceTo(1.0);
    return bench.arm().plant().q_rad;
  };
  EXPECT_EQ(end(5), end(5));
  EXPECT_NE(end(5), end(6));
}

}  // namespace
}  // namespace armada
