#include "firmware/link/channels.h"

#include <gtest/gtest.h>

namespace armada {
namespace {

TEST(Channels, OfEveryArmAreShortAndReadBack) {
  for (int id = 1; id <= kMaxArms; ++id) {
    EXPECT_EQ(EstimateChannel(id).view(), "EST_" + std::to_string(id));
    EXPECT_EQ(TelemetryChannel(id).view(), "TEL_" + std::to_string(id));
    EXPECT_LE(EstimateChannel(id).view().size(), kMaxChannelName);
    EXPECT_EQ(ParseArmChannel(kEstimatePrefix, EstimateChannel(id)), id);
    EXPECT_EQ(ParseArmChannel(kTelemetryPrefix, TelemetryChannel(id)), id);
    EXPECT_FALSE(ParseArmChannel(kEstimatePrefix, TelemetryChannel(id)));
  }
}

TEST(Channels, WithoutAnArmsIdAreNoArms) {
  for (const char* name : {"", "EST", "EST_", "EST_0", "EST_-1", "EST_+1", "EST_01", "EST_1x", "EST_ 1",
                           "EST_65", "EST_99999999999999999999", "est_1", "LEADER", "XEST_1"}) {
    EXPECT_FALSE(ParseArmChannel(kEstimatePrefix, name)) << name;
  }
}

}  // namespace
}  // namespace armada
