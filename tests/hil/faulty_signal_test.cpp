#include "hil/faulty_signal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace armada {
namespace {

constexpr double kStart_s = 0.5;

FaultySignal Signal(FaultWay way, double value, FaultSignal signal = FaultSignal::kPosition,
                    uint64_t seed = 1) {
  FaultConfig fault;
  fault.kind = FaultKind::kDrive;
  fault.signal = signal;
  fault.way = way;
  fault.value = value;
  return {fault, seed};
}

// What comes out of a truth that is its own time, each millisecond from the fault's begin on.
std::vector<double> Samples(FaultySignal signal, int samples) {
  std::vector<double> values;
  for (int k = 0; k < samples; ++k) {
    const double t_s = kStart_s + 0.001 * k;
    signal.Update(t_s, t_s);
    values.push_back(signal.Of(t_s));
  }
  return values;
}

TEST(FaultySignal, OffIsZero) {
  for (const double value : Samples(Signal(FaultWay::kOff, 0.0), 5)) EXPECT_EQ(value, 0.0);
}

TEST(FaultySignal, StuckRepeatsToTheBit) {
  for (const double value : Samples(Signal(FaultWay::kStuck, 0.0), 200)) EXPECT_EQ(value, kStart_s);
}

TEST(FaultySignal, WrongIsAddedOrAFactorOfACurrent) {
  EXPECT_EQ(Samples(Signal(FaultWay::kWrong, 0.25), 1)[0], kStart_s + 0.25);
  EXPECT_EQ(Samples(Signal(FaultWay::kWrong, -2.0, FaultSignal::kCurrent), 1)[0], -2.0 * kStart_s);
}

TEST(FaultySignal, GarbageIsAnotherNumberEachMillisecondWithinItsBounds) {
  const std::vector<double> values = Samples(Signal(FaultWay::kGarbage, 3.0), 1000);
  double sum = 0.0;
  for (const double value : values) {
    EXPECT_LE(std::abs(value), 3.0);
    sum += value;
  }
  EXPECT_NEAR(sum / 1000.0, 0.0, 0.3);
  EXPECT_EQ(std::set(values.begin(), values.end()).size(), 1000u);
  EXPECT_EQ(values, Samples(Signal(FaultWay::kGarbage, 3.0), 1000));
  EXPECT_NE(values, Samples(Signal(FaultWay::kGarbage, 3.0, FaultSignal::kPosition, 2), 1000));
}

TEST(FaultySignal, SlowIsRenewedOnceAPeriod) {
  const std::vector<double> values = Samples(Signal(FaultWay::kSlow, 0.02), 60);
  for (size_t k = 0; k < values.size(); ++k) {
    const size_t whole = k / 20;
    const auto periods = static_cast<double>(whole);
    EXPECT_NEAR(values[k], kStart_s + 0.02 * periods, 0.0011) << k;
  }
  EXPECT_EQ(std::set(values.begin(), values.end()).size(), 3u);
}

TEST(FaultySignal, DelayedIsThatOfSomeTimeAgo) {
  for (const double delay_s : {0.001, 0.005, 0.1}) {
    const std::vector<double> values = Samples(Signal(FaultWay::kDelayed, delay_s), 300);
    EXPECT_EQ(values[0], kStart_s);
    for (size_t k = 0; k < values.size(); ++k) {
      EXPECT_NEAR(values[k], kStart_s + std::max(0.0, 0.001 * static_cast<double>(k) - delay_s), 0.0011) << k;
    }
  }
}

TEST(FaultySignal, IntermittentIsZeroForItsShareOfTheTime) {
  int dropped = 0;
  for (const double value : Samples(Signal(FaultWay::kIntermittent, 0.2), 5000))
    dropped += value == 0.0 ? 1 : 0;
  EXPECT_NEAR(dropped, 1000, 100);
}

TEST(FaultySignal, WithNothingToRenewIsNeverDue) {
  EXPECT_TRUE(std::isinf(Signal(FaultWay::kStuck, 0.0).due_s()));
  EXPECT_TRUE(std::isinf(Signal(FaultWay::kWrong, 1.0).due_s()));
}

}  // namespace
}  // namespace armada
