#include "firmware/app/leader_news.h"

#include <gtest/gtest.h>

#include <cmath>

namespace armada {
namespace {

FleetConfig Fleet(int arms, std::vector<Topology> topologies, double topology_period_s = 0.0) {
  FleetConfig fleet;
  for (int id = 1; id <= arms; ++id) fleet.arms.emplace_back().id = id;
  fleet.topologies = std::move(topologies);
  fleet.topology_period_s = topology_period_s;
  return fleet;
}

void ExpectTicks(const FleetConfig& fleet, const std::vector<double>& expected) {
  const std::vector<double> news_s = OldestLeaderNews(fleet);
  ASSERT_EQ(news_s.size(), expected.size());
  for (size_t i = 0; i < expected.size(); ++i) {
    if (std::isinf(expected[i])) {
      EXPECT_TRUE(std::isinf(news_s[i])) << "arm " << i + 1;
    } else {
      EXPECT_NEAR(news_s[i] / fleet.timing.period_s, expected[i], 1e-9) << "arm " << i + 1;
    }
  }
}

TEST(LeaderNews, AgeByATickAHop) {
  ExpectTicks(Fleet(3, {{{{1, 2}, {2, 3}}, {{1}}}}), {1, 2, 3});
  ExpectTicks(Fleet(3, {{{{1, 2}, {2, 3}}, {{1}, {3}}}}), {1, 2, 1});
}

TEST(LeaderNews, NeverComeWhereNoTopologyBringsThem) {
  ExpectTicks(Fleet(3, {{{{2, 3}}, {{1}}}}), {1, INFINITY, INFINITY});
  ExpectTicks(Fleet(3, {{{{2, 3}}, {{1}}}, {{{3, 2}}, {{1}}}}, 0.05), {1, INFINITY, INFINITY});
}

// Ten ticks with the leader, ten without; then the tick until the next contact has its effect.
TEST(LeaderNews, AgeWhileATopologyBringsNone) {
  ExpectTicks(Fleet(1, {{{}, {{1}}}, {{}, {}}}, 0.1), {11});
}

TEST(LeaderNews, WaitForTheNextLinkInTheOrderOfTheTopologies) {
  const Topology pin = {{}, {{1}}};
  const Topology first = {{{1, 2}}, {}};
  const Topology second = {{{2, 3}}, {}};
  const double age_forwards = OldestLeaderNews(Fleet(3, {pin, first, second}, 0.05))[2];
  const double age_backwards = OldestLeaderNews(Fleet(3, {second, first, pin}, 0.05))[2];
  EXPECT_LT(age_forwards, 0.15 + 0.15);
  EXPECT_GT(age_backwards, 0.15 + 0.15);
}

TEST(LeaderNews, OfLongTopologiesNeedNoLongerToCompute) {
  ExpectTicks(Fleet(2, {{{{1, 2}}, {{1}}}, {{{2, 1}}, {{2}}}}, 1e6), {2, 2});
  ExpectTicks(Fleet(1, {{{}, {{1}}}, {{}, {}}}, 1e6), {1e8 + 1});
}

}  // namespace
}  // namespace armada
