// A bus with faults between a board and its drives, by itself and in an emulated arm.

#include "hil/faulty_wire.h"

#include <gtest/gtest.h>

#include <cmath>

#include "firmware/can/odrive_messages.h"
#include "hil/emulated_arm.h"

namespace armada {
namespace {

using Way = FaultyWire::Way;

FaultConfig Fault(FaultKind kind, double value = 0.0, double until_s = FaultConfig::kForGood_s) {
  FaultConfig fault;
  fault.kind = kind;
  fault.at_s = 1.0;
  fault.until_s = until_s;
  fault.arm = 4;
  fault.value = value;
  return fault;
}

CanFrame Numbered(uint32_t id) {
  CanFrame frame;
  frame.id = id;
  return frame;
}

TEST(FaultyWire, IsNoneWithoutAFaultOfTheArmsBus) {
  EXPECT_FALSE(MakeFaultyWire({}, 4, 1));
  EXPECT_FALSE(MakeFaultyWire({Fault(FaultKind::kBusOff)}, 3, 1));
  EXPECT_FALSE(MakeFaultyWire({Fault(FaultKind::kControllerDies)}, 4, 1));
  EXPECT_TRUE(MakeFaultyWire({Fault(FaultKind::kBusOff)}, 4, 1));
}

TEST(FaultyWire, LosesItsShareOfTheFrames) {
  FaultyWire wire({Fault(FaultKind::kBusLoss, 0.3)}, 5);
  int passed = 0;
  for (int i = 0; i < 1000; ++i) EXPECT_TRUE(wire.Passes(0.9, Numbered(1), Way::kToDrives));
  for (int i = 0; i < 10'000; ++i) passed += wire.Passes(1.1, Numbered(1), Way::kFromDrives) ? 1 : 0;
  EXPECT_NEAR(passed, 7000, 150);
  EXPECT_TRUE(std::isinf(wire.NextArrival()));
}

TEST(FaultyWire, KeepsTheOrderOfLateFrames) {
  FaultyWire wire({Fault(FaultKind::kBusDelay, 0.005, 1.1)}, 5);
  EXPECT_FALSE(wire.Passes(1.098, Numbered(1), Way::kToDrives));
  EXPECT_FALSE(wire.Passes(1.099, Numbered(2), Way::kFromDrives));
  EXPECT_FALSE(wire.Passes(1.1, Numbered(3), Way::kToDrives));  // in time, but behind the others
  EXPECT_NEAR(wire.NextArrival(), 1.103, 1e-12);
  EXPECT_FALSE(wire.TakeArrived(1.1025));
  const auto first = wire.TakeArrived(1.1035);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->frame.id, 1u);
  EXPECT_EQ(first->way, Way::kToDrives);
  EXPECT_FALSE(wire.TakeArrived(1.1035));
  EXPECT_EQ(wire.TakeArrived(1.2)->frame.id, 2u);
  EXPECT_EQ(wire.TakeArrived(1.2)->frame.id, 3u);
  EXPECT_TRUE(wire.Passes(1.2, Numbered(4), Way::kToDrives));
}

TEST(FaultyWire, IsCutWhileTheBusIsOffOrDown) {
  for (const FaultKind kind : {FaultKind::kBusOff, FaultKind::kBusDown}) {
    FaultyWire wire({Fault(kind, 0.0, 1.5)}, 5);
    EXPECT_TRUE(wire.Passes(0.99, Numbered(1), Way::kToDrives));
    EXPECT_FALSE(wire.Passes(1.0, Numbered(1), Way::kToDrives));
    EXPECT_FALSE(wire.Passes(1.49, Numbered(1), Way::kFromDrives));
    EXPECT_TRUE(wire.Passes(1.5, Numbered(1), Way::kFromDrives));
  }
}

/// One joint of 2 kg m^2 that is commanded 8 N m every 10 ms from 0 on.
class WireBench {
 public:
  explicit WireBench(const std::vector<FaultConfig>& faults)
      : arm_(Scenario(faults), 0, 1, {}, nullptr, 0.0) {
    Send(0.0,
         odrive::EncodeSetControllerMode(0, {odrive::ControlMode::kTorque, odrive::InputMode::kPassthrough}));
    Send(0.0, odrive::EncodeSetAxisState(0, odrive::AxisState::kClosedLoop));
  }

  void AdvanceTo(double t_s) {
    for (; 0.01 * ticks_ <= t_s + 1e-9; ++ticks_) {
      arm_.AdvanceTo(0.01 * ticks_, &out_);
      Send(0.01 * ticks_, odrive::EncodeEncoderRequest(0));
      Send(0.01 * ticks_, odrive::EncodeSetInputTorque(0, 8.0f));
    }
    arm_.AdvanceTo(t_s, &out_);
  }
  EmulatedArm& arm() { return arm_; }
  size_t answers() {
    size_t count = 0;
    for (const CanFrame& frame : out_) count += frame.id == 9 ? 1 : 0;
    out_.Clear();
    return count;
  }

 private:
  static ScenarioConfig Scenario(const std::vector<FaultConfig>& faults) {
    ScenarioConfig scenario;
    ArmEntry entry;
    entry.id = 4;
    entry.arm.dof = 1;
    entry.arm.links[0] = {2.0, 1.0, 0.5, 1.5};
    entry.joints.push_back({.node_id = 0, .torque_limit_Nm = 100.0});
    scenario.fleet.arms = {entry};
    scenario.disturbance.kind = DisturbanceKind::kNone;
    scenario.faults = faults;
    return scenario;
  }
  void Send(double t_s, const CanFrame& frame) { arm_.OnFrame(t_s, frame, &out_); }

  EmulatedArm arm_;
  FrameList out_;
  int ticks_ = 1;
};

// The last frame that arrives is that of 0.99 s: 30 ms later there is no torque any more.
TEST(EmulatedArmOnAFaultyWire, ADriveThatHearsNothingTripsItsWatchdog) {
  WireBench bench({Fault(FaultKind::kBusOff)});
  bench.AdvanceTo(1.0195);
  EXPECT_EQ(bench.arm().Torque()[0], 8.0);
  bench.AdvanceTo(1.0205);
  EXPECT_EQ(bench.arm().Torque()[0], 0.0);
  bench.AdvanceTo(3.0);
  EXPECT_EQ(bench.arm().Torque()[0], 0.0);
}

TEST(EmulatedArmOnAFaultyWire, AnswersComeTwiceTheDelayLater) {
  WireBench bench({Fault(FaultKind::kBusDelay, 0.002)});
  bench.AdvanceTo(1.0);
  bench.answers();
  bench.AdvanceTo(1.0035);
  EXPECT_EQ(bench.answers(), 0u);
  bench.AdvanceTo(1.0045);
  EXPECT_EQ(bench.answers(), 1u);
  EXPECT_EQ(bench.arm().Torque()[0], 8.0);
}

}  // namespace
}  // namespace armada
