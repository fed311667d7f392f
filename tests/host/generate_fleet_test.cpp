#include "host/fleet/generate_fleet.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "firmware/app/config/fleet_file.h"
#include "firmware/app/config/toml_parser.h"
#include "host/fleet/toml_text.h"

namespace armada {
namespace {

FleetPlan Plan(GraphShape graph, int arms) {
  FleetPlan plan;
  plan.graph = graph;
  plan.like = ARMADA_SOURCE_DIR "/firmware/fleets/paper.toml";
  plan.name = "test";
  plan.command = "armada fleet ..";
  plan.arms = arms;
  return plan;
}

std::string TextOf(const FleetPlan& plan) {
  std::vector<ConfigError> errors;
  const auto text = GenerateFleet(plan, &errors);
  for (const ConfigError& error : errors) ADD_FAILURE() << ToString(error);
  return text.value_or("");
}

FleetConfig ReadFleet(const std::string& text) {
  std::vector<ConfigError> errors;
  auto tree = ParseToml(text, "generated", &errors);
  auto loaded = tree ? FleetFromTree(std::move(*tree), "generated", &errors) : std::nullopt;
  for (const ConfigError& error : errors) ADD_FAILURE() << ToString(error);
  return loaded ? loaded->fleet : FleetConfig{};
}

FleetConfig Fleet(const FleetPlan& plan) {
  return ReadFleet(TextOf(plan));
}

std::vector<int> Depths(const FleetConfig& fleet) {
  const auto depth = fleet.Graph(0).DepthFromLeader();
  return {depth.begin(), depth.begin() + static_cast<int>(fleet.arms.size())};
}

TEST(GenerateFleet, ShapesAreWhatTheirNamesSay) {
  const FleetConfig line = Fleet(Plan(GraphShape::kLine, 5));
  EXPECT_EQ(Depths(line), (std::vector<int>{1, 2, 3, 4, 5}));
  EXPECT_EQ(line.topologies[0].edges.size(), 4u);
  const FleetConfig ring = Fleet(Plan(GraphShape::kRing, 5));
  EXPECT_EQ(Depths(ring), (std::vector<int>{1, 2, 3, 4, 5}));
  EXPECT_EQ(ring.Graph(0).weight(0, 4), 1.0);
  EXPECT_EQ(Depths(Fleet(Plan(GraphShape::kTree, 7))), (std::vector<int>{1, 2, 2, 3, 3, 3, 3}));
}

TEST(GenerateFleet, ArmsAreThoseOfTheFileInTurnOnBusesOfTheirOwn) {
  std::vector<ConfigError> errors;
  const FleetConfig paper = LoadFleet(Plan(GraphShape::kLine, 1).like, {}, &errors).value();
  const FleetConfig fleet = Fleet(Plan(GraphShape::kTree, 16));
  for (size_t i = 0; i < fleet.arms.size(); ++i) {
    const ArmEntry& model = paper.arms[i % paper.arms.size()];
    EXPECT_EQ(fleet.arms[i].id, static_cast<int>(i) + 1);
    EXPECT_EQ(fleet.arms[i].arm.links[1].I_kgm2, model.arm.links[1].I_kgm2);
    EXPECT_EQ(fleet.arms[i].control.subtask.kind, model.control.subtask.kind);
    EXPECT_EQ(fleet.arms[i].joints[0].torque_limit_Nm, model.joints[0].torque_limit_Nm);
  }
  EXPECT_EQ(fleet.arms[15].bus, "udp:239.74.163.26:43113");
}

TEST(GenerateFleet, VariedLinksStayWithinTheShare) {
  FleetPlan plan = Plan(GraphShape::kLine, 7);
  const FleetConfig same = Fleet(plan);
  plan.vary = 0.1;
  const FleetConfig varied = Fleet(plan);
  int changed = 0;
  for (size_t i = 0; i < same.arms.size(); ++i) {
    for (size_t k = 0; k < static_cast<size_t>(same.arms[i].arm.dof); ++k) {
      const LinkConfig& from = same.arms[i].arm.links[k];
      const LinkConfig& to = varied.arms[i].arm.links[k];
      for (const auto& [a, b] :
           {std::pair{from.m_kg, to.m_kg}, {from.l_m, to.l_m}, {from.I_kgm2, to.I_kgm2}}) {
        EXPECT_NEAR(b / a, 1.0, 0.101);
        changed += a != b ? 1 : 0;
      }
      EXPECT_NEAR(to.r_m / to.l_m, from.r_m / from.l_m, 2e-3);
    }
  }
  EXPECT_GT(changed, 40);
}

TEST(GenerateFleet, RandomDigraphsReachEverybodyThroughCyclesToo) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    FleetPlan plan = Plan(GraphShape::kRandom, 50);
    plan.seed = seed;
    plan.pins = 1 + static_cast<int>(seed % 5);
    const FleetConfig fleet = Fleet(plan);
    ASSERT_EQ(fleet.arms.size(), 50u);
    EXPECT_TRUE(fleet.Graph(0).LeaderReachesAll());
    EXPECT_EQ(static_cast<int>(fleet.topologies[0].pins.size()), plan.pins);
    const auto& edges = fleet.topologies[0].edges;
    EXPECT_TRUE(
        std::any_of(edges.begin(), edges.end(), [](const Edge& edge) { return edge.from > edge.to; }));
    EXPECT_GT(edges.size(), 75u);
  }
}

TEST(GenerateFleet, TheSameSeedGivesTheSameBytesAndAnotherOneOthers) {
  FleetPlan plan = Plan(GraphShape::kRandom, 12);
  plan.vary = 0.1;
  const std::string first = TextOf(plan);
  EXPECT_EQ(TextOf(plan), first);
  plan.seed = 2;
  EXPECT_NE(TextOf(plan), first);
}

TEST(GenerateFleet, DeepGraphsGetAnEstimatorThatSeesToTheirEnd) {
  const FleetConfig fleet = Fleet(Plan(GraphShape::kLine, 40));
  EXPECT_EQ(fleet.estimator.sync_ticks, 42);
  EXPECT_EQ(fleet.estimator.age_max_s, 0.8);
  EXPECT_EQ(Fleet(Plan(GraphShape::kLine, 5)).estimator.sync_ticks, EstimatorConfig().sync_ticks);
}

TEST(GenerateFleet, SaysWhatIsWrongWithTheFile) {
  FleetPlan plan = Plan(GraphShape::kLine, 3);
  plan.like = "nowhere.toml";
  std::vector<ConfigError> errors;
  EXPECT_FALSE(GenerateFleet(plan, &errors).has_value());
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].file, "nowhere.toml");
}

TEST(TomlText, ReadsBackToTheSameTree) {
  constexpr const char* kText =
      "name = \"a \\\"quoted\\\" name\"\n"
      "flag = true\n"
      "list = [1, 2.5, [3]]\n"
      "flat = [\n"
      "  { a = 1, b = 2 }, { a = 3, b = 4 },\n"
      "]\n"
      "long = [\n"
      "  { a = 1, b = 2, c = 3, d = 4 },\n"
      "  { a = 5, b = 6, c = 7, d = 8 },\n"
      "]\n"
      "\n"
      "[table]\n"
      "x = -0.5\n"
      "\n"
      "[table.below]\n"
      "y = 1\n"
      "\n"
      "[[deep]]\n"
      "z = [1]\n";
  std::vector<ConfigError> errors;
  const auto tree = ParseToml(kText, "text", &errors);
  ASSERT_TRUE(tree.has_value());
  EXPECT_EQ(TomlText(*tree), kText);
}

}  // namespace
}  // namespace armada
