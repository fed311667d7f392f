// A board's process under the faults of its arm.

#include "host/sim/board_process.h"

#include <gtest/gtest.h>

#include "tests/closed_loop/fault_at_one.h"

namespace armada {
namespace {

using Turn = BoardProcess::Turn;

BoardProcess Process(const FaultConfig& fault) {
  ScenarioConfig scenario;
  scenario.fleet.timing.bring_up_s = 0.05;
  scenario.faults = {fault};
  return {scenario, 1};
}

/// A tick whose samples are there at once.
Turn TurnAt(BoardProcess& process, int64_t k) {
  const Turn turn = process.Begin(k);
  process.Answers(0.01 * static_cast<double>(k), true);
  return turn;
}

TEST(BoardFaults, ABusThatWasOffIsRestarted) {
  const BoardFaults faults({FaultAtOne(FaultKind::kBusOff)}, 1);
  EXPECT_EQ(faults.BusAt(0.99, 0.01), BusStatus::kOk);
  EXPECT_EQ(faults.BusAt(1.0, 0.01), BusStatus::kBusOff);
  EXPECT_EQ(faults.BusAt(2.99, 0.01), BusStatus::kBusOff);
  EXPECT_EQ(faults.BusAt(3.0, 0.01), BusStatus::kRestarted);
  EXPECT_EQ(faults.BusAt(3.01, 0.01), BusStatus::kOk);
}

TEST(BoardFaults, ABusThatWasErrorPassiveIsActiveAgain) {
  const BoardFaults faults({FaultAtOne(FaultKind::kErrorPassive)}, 1);
  EXPECT_EQ(faults.BusAt(2.99, 0.01), BusStatus::kErrorPassive);
  EXPECT_EQ(faults.BusAt(3.0, 0.01), BusStatus::kErrorActive);
  EXPECT_EQ(faults.BusAt(3.01, 0.01), BusStatus::kOk);
}

TEST(BoardFaults, AreThoseOfTheirArm) {
  const std::vector<FaultConfig> all = {FaultAtOne(FaultKind::kControllerStops),
                                        FaultAtOne(FaultKind::kSlowTick, 0.02, 2),
                                        FaultAtOne(FaultKind::kErrorPassive, 0.0, 2)};
  const BoardFaults first(all, 1);
  const BoardFaults second(all, 2);
  EXPECT_TRUE(first.Stops(2.0));
  EXPECT_EQ(first.ComputeTime_s(2.0), 0.0);
  EXPECT_EQ(first.BusAt(2.0, 0.01), BusStatus::kOk);
  EXPECT_FALSE(second.Stops(2.0));
  EXPECT_EQ(second.ComputeTime_s(2.0), 0.02);
  EXPECT_EQ(second.BusAt(2.0, 0.01), BusStatus::kErrorPassive);
}

TEST(BoardProcess, WithoutAFaultAnswersEachTickAtOnceWithOrWithoutSamples) {
  BoardProcess process = Process(FaultAtOne(FaultKind::kSlowTick, 0.02, 2));
  for (int64_t k = 0; k < 300; ++k) {
    EXPECT_TRUE(process.IsOnTime(k));
    EXPECT_EQ(process.Begin(k), Turn::kTick);
    EXPECT_TRUE(process.Answers(0.01 * static_cast<double>(k), false));
    EXPECT_EQ(process.missed_ticks(), 0);
  }
}

TEST(BoardProcess, WaitsForLateSamplesAsLongAsItMay) {
  BoardProcess process = Process(FaultAtOne(FaultKind::kBusLoss, 0.5));
  EXPECT_EQ(process.Begin(150), Turn::kTick);
  EXPECT_FALSE(process.Answers(1.5, false));
  EXPECT_FALSE(process.Answers(1.502, false));
  EXPECT_TRUE(process.busy());
  EXPECT_TRUE(process.Answers(1.503, false));  // timing.feedback_timeout_s
  EXPECT_FALSE(process.Answers(1.504, false));
  EXPECT_EQ(process.Begin(151), Turn::kTick);
  EXPECT_FALSE(process.Answers(1.51, false));
  EXPECT_TRUE(process.Answers(1.512, true));
}

TEST(BoardProcess, ThatIsStoppedMissesItsTicks) {
  BoardProcess process = Process(FaultAtOne(FaultKind::kControllerStops));
  EXPECT_EQ(TurnAt(process, 99), Turn::kTick);
  for (int64_t k = 100; k < 300; ++k) {
    EXPECT_FALSE(process.IsOnTime(k));
    EXPECT_EQ(TurnAt(process, k), Turn::kMissed);
  }
  EXPECT_EQ(process.tick(), 99);
  EXPECT_EQ(TurnAt(process, 300), Turn::kTick);
  EXPECT_EQ(process.missed_ticks(), 200);
  EXPECT_EQ(TurnAt(process, 301), Turn::kTick);
  EXPECT_EQ(process.missed_ticks(), 0);
}

TEST(BoardProcess, ThatIsSlowMissesTheTicksThatItIsBusyIn) {
  BoardProcess process = Process(FaultAtOne(FaultKind::kSlowTick, 0.025));
  EXPECT_EQ(process.Begin(150), Turn::kTick);
  EXPECT_FALSE(process.Answers(1.5, true));
  EXPECT_EQ(process.Begin(151), Turn::kMissed);
  EXPECT_EQ(process.Begin(152), Turn::kMissed);
  EXPECT_FALSE(process.Answers(1.524, true));
  EXPECT_TRUE(process.Answers(1.525, true));
  EXPECT_EQ(process.tick(), 150);
  EXPECT_EQ(process.Begin(153), Turn::kTick);
  EXPECT_EQ(process.missed_ticks(), 2);
}

TEST(BoardProcess, ThatIsKilledStartsAnew) {
  BoardProcess process = Process(FaultAtOne(FaultKind::kControllerRestarts));
  EXPECT_EQ(TurnAt(process, 99), Turn::kTick);
  EXPECT_EQ(TurnAt(process, 100), Turn::kNone);
  EXPECT_FALSE(process.running());
  EXPECT_EQ(TurnAt(process, 299), Turn::kNone);
  EXPECT_EQ(TurnAt(process, 300), Turn::kStart);
  EXPECT_TRUE(process.running());
  EXPECT_EQ(process.first_tick(), 305);
  for (int64_t k = 301; k < 305; ++k) EXPECT_EQ(TurnAt(process, k), Turn::kStarts);
  EXPECT_FALSE(process.IsOnTime(304));
  EXPECT_TRUE(process.IsOnTime(305));
  EXPECT_EQ(TurnAt(process, 305), Turn::kTick);
  EXPECT_EQ(process.starts(), 2u);
}

TEST(BoardProcess, KilledInATickNeverAnswersIt) {
  FaultConfig fault = FaultAtOne(FaultKind::kControllerDies);
  fault.at_s = 1.502;
  BoardProcess process = Process(fault);
  EXPECT_EQ(process.Begin(150), Turn::kTick);
  EXPECT_FALSE(process.Answers(1.501, false));
  EXPECT_FALSE(process.Answers(1.503, true));
}

}  // namespace
}  // namespace armada
