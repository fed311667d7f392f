#include "hil/tracking_record.h"

#include <gtest/gtest.h>

namespace armada {
namespace {

ScenarioConfig RecordedScenario() {
  ScenarioConfig scenario;
  scenario.window_start_s = 2.0;
  scenario.criterion.error_max_m = 0.02;
  return scenario;
}

TEST(TrackingRecord, MeasuresTheWindowOnly) {
  TrackingRecord record(RecordedScenario());
  record.Update(1.999, 5.0);
  record.Update(2.0, 0.003);
  record.Update(2.001, -0.0);
  record.Update(2.002, 0.004);
  EXPECT_EQ(record.count(), 3);
  EXPECT_DOUBLE_EQ(record.max_m(), 0.004);
  EXPECT_DOUBLE_EQ(record.sum_squares_m2(), 25e-6);
  EXPECT_DOUBLE_EQ(record.rms_m(), std::sqrt(25e-6 / 3.0));
}

TEST(TrackingRecord, IsSettledFromTheLastEntryIntoTheBand) {
  TrackingRecord record(RecordedScenario());
  EXPECT_FALSE(record.settled_s().has_value());
  record.Update(0.1, 0.5);
  EXPECT_FALSE(record.settled_s().has_value());
  record.Update(0.2, 0.01);
  record.Update(0.3, 0.01);
  EXPECT_EQ(record.settled_s(), 0.2);
  record.Update(0.4, 0.02);  // the band's edge is outside
  EXPECT_FALSE(record.settled_s().has_value());
  record.Update(0.5, 0.019);
  EXPECT_EQ(record.settled_s(), 0.5);
}

TEST(TrackingRecord, IsZeroWithoutSamples) {
  const TrackingRecord record(RecordedScenario());
  EXPECT_EQ(record.count(), 0);
  EXPECT_EQ(record.rms_m(), 0.0);
}

}  // namespace
}  // namespace armada
