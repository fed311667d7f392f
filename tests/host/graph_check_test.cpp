// Who is reached by whom, and what the loss of a link cuts off.

#include <gtest/gtest.h>

#include <sstream>
#include <tuple>

#include "host/check/check_output.h"
#include "tests/host/paper_scenario.h"

namespace armada {
namespace {

using Cut = std::tuple<int, int, std::vector<int>>;
std::vector<Cut> CutsOf(const TopologyCheck& topology) {
  std::vector<Cut> cuts;
  for (const SingleCut& cut : topology.single_cuts) cuts.emplace_back(cut.from_id, cut.to_id, cut.cut_ids);
  return cuts;
}

TEST(GraphCheck, PapersGraphReachesAllWithinTwoHops) {
  const auto topologies = CheckTopologies(PaperScenario().fleet);
  ASSERT_EQ(topologies.size(), 1u);
  EXPECT_TRUE(topologies[0].holds());
  EXPECT_EQ(topologies[0].depth, (std::vector<int>{1, 2, 1, 2, 1, 2, 1}));
}

TEST(GraphCheck, NamesTheLinksThatHaveNoSubstituteAndWhomTheyCutOff) {
  // Arms 2 and 4 hear both 1 and 3; arm 6 hears 5 only.
  const auto topologies = CheckTopologies(PaperScenario().fleet);
  const std::vector<Cut> expected = {
      {kLeaderId, 1, {1}}, {kLeaderId, 3, {3}}, {kLeaderId, 5, {5, 6}}, {kLeaderId, 7, {7}}, {5, 6, {6}}};
  EXPECT_EQ(CutsOf(topologies[0]), expected);
}

TEST(GraphCheck, ArmWithoutAPathIsNamed) {
  FleetConfig fleet = PaperScenario().fleet;
  fleet.topologies[0].edges.pop_back();
  const CheckResult result = BuildCheck(fleet);
  EXPECT_FALSE(result.ok());
  std::ostringstream out;
  PrintText(result, out);
  EXPECT_NE(out.str().find("NOT REACHED: 6;"), std::string::npos);
}

TEST(GraphCheck, EachTopologyIsJudgedByItself) {
  FleetConfig fleet = PaperScenario().fleet;
  fleet.topologies.push_back(fleet.topologies[0]);
  fleet.topologies[1].pins = {{7}};
  fleet.topology_period_s = 0.5;
  const auto topologies = CheckTopologies(fleet);
  EXPECT_TRUE(topologies[0].holds());
  EXPECT_FALSE(topologies[1].holds());
  EXPECT_FALSE(BuildCheck(fleet).ok());
}

std::string TextOf(const CheckResult& result) {
  std::ostringstream out;
  PrintText(result, out);
  return out.str();
}

TEST(GraphCheck, TopologiesThatReachAllInTurnHoldWithAWarning) {
  ScenarioConfig scenario = PaperScenario();
  FleetConfig& fleet = scenario.fleet;
  fleet.topologies = {{{{5, 6}}, {{1}, {3}}}, {{{1, 2}, {1, 4}}, {{5}, {7}}}};
  fleet.topology_period_s = 0.05;
  const CheckResult result = BuildCheck(scenario);
  EXPECT_TRUE(result.A1());
  EXPECT_TRUE(result.ok());
  EXPECT_TRUE(Mentions(result, Severity::kWarning, "less than Corollary 3 asks for"));
  EXPECT_NE(
      TextOf(result).find("news of the leader at most 0.11 s old (arm 2); they count as lost above 0.20 s"),
      std::string::npos)
      << TextOf(result);
  EXPECT_GT(result.arms[5].estimate->x_m, 100.0 * BuildCheck(PaperScenario()).arms[5].estimate->x_m);

  fleet.topology_period_s = 0.2;
  EXPECT_FALSE(BuildCheck(scenario).A1());
}

TEST(GraphCheck, ArmsThatALostLinkCutsOffMustBeExpectedToStand) {
  ScenarioConfig scenario = PaperScenario();
  scenario.network.lost = {{.from = 5, .to = 6, .at_s = 10.0}};
  EXPECT_TRUE(Mentions(BuildCheck(scenario), Severity::kError, "arm 6 loses the leader"));
  EXPECT_FALSE(BuildCheck(scenario).ok());
  scenario.criterion.standing = {6};
  EXPECT_TRUE(Mentions(BuildCheck(scenario), Severity::kWarning, "arm 6 loses the leader"));
  EXPECT_TRUE(BuildCheck(scenario).ok());
  scenario.criterion.standing = {6, 4};
  EXPECT_TRUE(Mentions(BuildCheck(scenario), Severity::kError, "arm 4 is to stand still"));
  scenario.criterion.standing = {};
  scenario.network.lost[0].until_s = 20.0;  // it comes back
  EXPECT_TRUE(BuildCheck(scenario).ok());
}

TEST(GraphCheck, LeaderlessFleetNeedsARootOfItsOwn) {
  FleetConfig fleet = PaperScenario().fleet;
  fleet.estimator.leaderless = true;
  fleet.arms.resize(3);
  fleet.topologies = {{{{2, 1}, {2, 3}}, {}}};
  auto topologies = CheckTopologies(fleet);
  EXPECT_TRUE(topologies[0].holds());
  EXPECT_EQ(topologies[0].root_id, 2);
  EXPECT_EQ(topologies[0].depth, (std::vector<int>{1, 0, 1}));
  EXPECT_EQ(CutsOf(topologies[0]), (std::vector<Cut>{{2, 1, {1}}, {2, 3, {3}}}));

  fleet.topologies = {{{{1, 2}, {2, 3}, {3, 1}}, {}}};  // a ring: any one link may go
  topologies = CheckTopologies(fleet);
  EXPECT_TRUE(topologies[0].holds());
  EXPECT_TRUE(topologies[0].single_cuts.empty());
}

}  // namespace
}  // namespace armada
