// The paper's fleet of estimators: Theorem 1's time bound, accuracy by order of h, Corollaries 2 and 3.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/estimator_network.h"
#include "tests/core/estimators.h"
#include "tests/core/paper_setting.h"
#include "tests/support/graphs.h"
#include "tests/support/random_arms.h"

namespace armada {
namespace {

std::vector<Zeta> RandomStart(uint64_t seed, size_t count) {
  RandomArms random(seed);
  std::vector<Zeta> start;
  for (size_t i = 0; i < count; ++i) {
    start.push_back({random.Numbers<TaskVector>(2, 5.0), random.Numbers<TaskVector>(2, 5.0),
                     random.Numbers<TaskVector>(2, 5.0)});
  }
  return start;
}

// Root of the mean of |error|^2 over time and arms.
struct Rms {
  double x_m, v_m_s, a_m_s2;
};

struct Setting {
  EstimatorKind kind = EstimatorKind::kPredictive;
  bool tells_jerk = false;  // the leader
  double h_s = 0.01;
};

// Tracks the paper's leader from random states; errors over t = 8 .. 12 s, two of its laps.
Rms MeasureRms(const Setting& setting, const Digraph& graph = PaperGraph()) {
  const double h_s = setting.h_s;
  EstimatorNetwork network(ConfigOf(setting.kind), graph,
                           RandomStart(7, static_cast<size_t>(graph.node_count())));
  Rms sum{};
  int count = 0;
  const int ticks = static_cast<int>(std::lround(12.0 / h_s));
  for (int k = 0; k < ticks; ++k) {
    network.Tick(PaperLeader(k * h_s), h_s,
                 setting.tells_jerk ? PaperLeaderJerk(k * h_s) : TaskVector(TaskVector::Zero(2)));
    if (k * h_s < 8.0) continue;
    const Zeta leader = PaperLeader((k + 1) * h_s);
    for (const Estimator& node : network.nodes()) {
      sum.x_m += (node.zeta().x_m - leader.x_m).squaredNorm();
      sum.v_m_s += (node.zeta().v_m_s - leader.v_m_s).squaredNorm();
      sum.a_m_s2 += (node.zeta().a_m_s2 - leader.a_m_s2).squaredNorm();
      ++count;
    }
  }
  return {std::sqrt(sum.x_m / count), std::sqrt(sum.v_m_s / count), std::sqrt(sum.a_m_s2 / count)};
}

TEST(EstimatorNetwork, AccuracyAtTenMillisecondsIsTheDocumented) {
  const double paper_m = MeasureRms({EstimatorKind::kPaper}).x_m;
  EXPECT_GT(paper_m, 0.030);
  EXPECT_LT(paper_m, 0.050);
  EXPECT_LT(MeasureRms({EstimatorKind::kImplicit}).x_m, 0.025);
  EXPECT_LT(MeasureRms({EstimatorKind::kPredictive}).x_m, 15e-6);
  EXPECT_LT(MeasureRms({EstimatorKind::kPredictive, true}).x_m, 0.2e-6);
}

// Orders in h of x, v and a, between h, h/2 and h/4.
void ExpectOrders(bool tells_jerk, const Digraph& graph, double h_s, double x, double v, double a) {
  const auto measure = [&](double period_s) {
    return MeasureRms({EstimatorKind::kPredictive, tells_jerk, period_s}, graph);
  };
  const Rms coarse = measure(h_s);
  const Rms middle = measure(h_s / 2);
  const Rms fine = measure(h_s / 4);
  for (const auto& [more, less] : {std::pair{coarse, middle}, std::pair{middle, fine}}) {
    EXPECT_NEAR(std::log2(more.x_m / less.x_m), x, 0.2);
    EXPECT_NEAR(std::log2(more.v_m_s / less.v_m_s), v, 0.2);
    EXPECT_NEAR(std::log2(more.a_m_s2 / less.a_m_s2), a, 0.2);
  }
}

TEST(EstimatorNetwork, PredictiveIsOfFourthThirdAndSecondOrder) {
  ExpectOrders(true, PaperGraph(), 0.02, 4, 3, 2);
}

TEST(EstimatorNetwork, WithoutTheLeadersJerkItIsOfThirdSecondAndFirstOrder) {
  ExpectOrders(false, PaperGraph(), 0.02, 3, 2, 1);
}

TEST(EstimatorNetwork, OrdersAreTheSameOnOtherGraphs) {
  for (const Digraph& graph : {LineGraph(7), TwoWayRingGraph(7), RandomGraph(20, 1), RandomGraph(20, 2)}) {
    ASSERT_TRUE(graph.LeaderReachesAll());
    ExpectOrders(true, graph, 0.016, 4, 3, 2);
    ExpectOrders(false, graph, 0.016, 3, 2, 1);
  }
}

// A node hears what it told others; were that averaged in, as by (1.9) on all neighbours, errors would be a
// thousand times as large.
TEST(EstimatorNetwork, ErrorsDoNotReturnAroundCycles) {
  const auto error_m = [](const Digraph& graph) {
    return MeasureRms({EstimatorKind::kPredictive, true}, graph).x_m;
  };
  EXPECT_LT(error_m(TwoWayRingGraph(7)), error_m(LineGraph(7)));
  EXPECT_LT(error_m(RandomGraph(50, 3)), error_m(LineGraph(7)));
}

TEST(EstimatorNetwork, WithoutPredictionItIsOfFirstOrder) {
  for (const EstimatorKind kind : {EstimatorKind::kPaper, EstimatorKind::kImplicit}) {
    const double coarse_m = MeasureRms({kind, false, 0.01}).x_m;
    EXPECT_NEAR(std::log2(coarse_m / MeasureRms({kind, false, 0.005}).x_m), 1.0, 0.15);
  }
}

double LargestError(const EstimatorNetwork& network, TaskVector Zeta::*block, const Zeta& leader) {
  double largest = 0.0;
  for (const Estimator& node : network.nodes()) {
    largest = std::max(largest, (node.zeta().*block - leader.*block).cwiseAbs().maxCoeff());
  }
  return largest;
}

// Theorem 1 with t_0 = 0, from the states at the start.
double TheoremTime(double start_error, double beta, double supremum) {
  return start_error / (beta - supremum);
}

// Errors are small multiples of h beta: two hops down the tree, each at most two steps off. The theorem
// speaks of (1.9); that prediction keeps to the same times from these starts is measured, not proved.
class EstimatorNetworkFromAStart : public testing::TestWithParam<uint64_t> {};

TEST_P(EstimatorNetworkFromAStart, NoComponentLeavesItsBandAfterTheTheoremsTime) {
  constexpr double kH_s = 1e-4;
  constexpr double kPassingDown_s = 5.0 * kH_s;
  for (const EstimatorKind kind : kEstimatorKinds) {
    const EstimatorConfig config = ConfigOf(kind);
    EstimatorNetwork network(config, PaperGraph(), RandomStart(GetParam(), 7));
    const Zeta start = PaperLeader(0.0);
    const double t_f1 =
        TheoremTime(LargestError(network, &Zeta::x_m, start), config.beta_1_m_s, kLeaderSpeed_m_s);
    const double t_f2 =
        TheoremTime(LargestError(network, &Zeta::v_m_s, start), config.beta_2_m_s2, kLeaderAcceleration_m_s2);
    const double t_f3 =
        TheoremTime(LargestError(network, &Zeta::a_m_s2, start), config.beta_3_m_s3, kLeaderJerk_m_s3);
    const double t_f = std::max({t_f1, t_f2, t_f3});
    for (int k = 0; k * kH_s < t_f + 1.0; ++k) {
      network.Tick(PaperLeader(k * kH_s), kH_s);
      const double t_s = (k + 1) * kH_s;
      const Zeta leader = PaperLeader(t_s);
      const auto expect_near = [&](double t_f_s, TaskVector Zeta::*block, double beta) {
        if (t_s <= t_f_s + kPassingDown_s) return;
        ASSERT_LE(LargestError(network, block, leader), 4.0 * kH_s * beta);
      };
      expect_near(t_f1, &Zeta::x_m, config.beta_1_m_s);
      expect_near(t_f2, &Zeta::v_m_s, config.beta_2_m_s2);
      expect_near(t_f3, &Zeta::a_m_s2, config.beta_3_m_s3);
      if (t_s <= t_f + kPassingDown_s) continue;
      for (const Estimator& node : network.nodes()) ASSERT_TRUE(node.in_band()) << "at " << t_s << " s";
    }
    for (const Estimator& node : network.nodes()) EXPECT_TRUE(node.synced());
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, EstimatorNetworkFromAStart, testing::Values(1, 2, 3));

TEST(EstimatorNetwork, NobodyIsSyncedBeforeEverybodyUpstreamAgrees) {
  EstimatorNetwork network(ConfigOf(EstimatorKind::kPredictive), PaperGraph(), RandomStart(4, 7));
  bool listener_synced = false;
  for (int k = 0; k < 600 && !listener_synced; ++k) {
    const int before = network.nodes()[4].agreement();
    network.Tick(PaperLeader(k * 0.01), 0.01);
    listener_synced = network.nodes()[5].synced();
    EXPECT_LE(network.nodes()[5].agreement(), before + 1);
    if (listener_synced) {
      EXPECT_TRUE(network.nodes()[4].synced());
      const Zeta leader = PaperLeader((k + 1) * 0.01);
      EXPECT_LT((network.nodes()[5].zeta().x_m - leader.x_m).norm(), 0.05);
    }
  }
  EXPECT_TRUE(listener_synced);
}

// Arms that also listen to each other must not wait for each other for ever.
TEST(EstimatorNetwork, SyncsThroughCycles) {
  Digraph graph(4);
  graph.SetPin(0, 1.0);
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      if (i != j) graph.SetWeight(i, j, 1.0);
    }
  }
  for (const EstimatorKind kind : kEstimatorKinds) {
    EstimatorNetwork network(ConfigOf(kind), graph, RandomStart(5, 4));
    for (int k = 0; k < 1500; ++k) network.Tick(PaperLeader(k * 0.01), 0.01);
    for (const Estimator& node : network.nodes()) EXPECT_TRUE(node.synced());
  }
}

Digraph Ring(int count, bool both_ways) {
  Digraph ring(count);
  for (int i = 0; i < count; ++i) {
    ring.SetWeight(i, (i + 1) % count, 1.0);
    if (both_ways) ring.SetWeight((i + 1) % count, i, 1.0);
  }
  return ring;
}

TEST(EstimatorNetwork, LeaderlessArmsAgreeOnAPointBetweenThem) {  // Corollary 2
  for (const EstimatorKind kind : {EstimatorKind::kImplicit, EstimatorKind::kPredictive}) {
    for (const bool both_ways : {true, false}) {
      EstimatorConfig config = ConfigOf(kind);
      config.leaderless = true;
      std::vector<Zeta> start = RandomStart(6, 7);
      for (Zeta& zeta : start) zeta.x_m.array() += 20.0;  // the origin is not between them
      EstimatorNetwork network(config, Ring(7, both_ways), start);
      for (int k = 0; k < 1500; ++k) network.Tick(Zeta::Zero(2), 0.01);

      TaskVector low = start[0].x_m;
      TaskVector high = start[0].x_m;
      for (const Zeta& zeta : start) {
        low = low.cwiseMin(zeta.x_m);
        high = high.cwiseMax(zeta.x_m);
      }
      const TaskVector agreed = network.nodes()[0].zeta().x_m;
      EXPECT_TRUE((agreed.array() >= low.array()).all() && (agreed.array() <= high.array()).all());
      for (const Estimator& node : network.nodes()) {
        EXPECT_LT((node.zeta().x_m - agreed).norm(), 1e-6);
        EXPECT_TRUE(node.zeta().v_m_s.isZero());
        EXPECT_TRUE(node.zeta().a_m_s2.isZero());
        EXPECT_TRUE(node.synced());
      }
    }
  }
}

TEST(EstimatorNetwork, LeaderlessPaperKindAgreesUpToItsChatter) {
  EstimatorConfig config = ConfigOf(EstimatorKind::kPaper);
  config.leaderless = true;
  EstimatorNetwork network(config, Ring(7, true), RandomStart(6, 7));
  for (int k = 0; k < 3000; ++k) network.Tick(Zeta::Zero(2), 0.01);
  for (const Estimator& node : network.nodes()) {
    EXPECT_LT((node.zeta().x_m - network.nodes()[0].zeta().x_m).cwiseAbs().maxCoeff(),
              8.0 * 0.01 * config.beta_1_m_s);
  }
}

TEST(EstimatorNetwork, SwitchingTopologiesThatEachReachAllKeepTheLeader) {  // Corollary 3
  Digraph chain(7);
  chain.SetPin(6, 0.5);
  for (int i = 0; i < 6; ++i) chain.SetWeight(i, i + 1, 2.0);
  ASSERT_TRUE(chain.LeaderReachesAll());

  EstimatorNetwork network(ConfigOf(EstimatorKind::kPredictive), PaperGraph(), RandomStart(8, 7));
  for (int k = 0; k < 1500; ++k) {
    if (k % 50 == 0) network.Switch(k % 100 == 0 ? PaperGraph() : chain);
    network.Tick(PaperLeader(k * 0.01), 0.01);
    if (k < 600) continue;
    const Zeta leader = PaperLeader((k + 1) * 0.01);
    ASSERT_LT(LargestError(network, &Zeta::x_m, leader), 1e-3);
    for (const Estimator& node : network.nodes()) ASSERT_TRUE(node.synced());
  }
}

TEST(EstimatorNetwork, ALostLeaderIsNoticedByEveryArmOfAChain) {
  const EstimatorConfig config;
  Digraph chain(4);
  chain.SetPin(0, 1.0);
  for (int i = 1; i < 4; ++i) chain.SetWeight(i, i - 1, 1.0);
  const Zeta leader = Zeta::Zero(2);
  EstimatorNetwork network(config, chain, std::vector<Zeta>(4, leader));
  for (int k = 0; k < 50; ++k) network.Tick(leader, 0.01);
  for (const Estimator& node : network.nodes()) ASSERT_TRUE(node.synced());
  chain.SetPin(0, 0.0);  // the first arm hears nobody now, the others still hear each other
  network.Switch(chain);
  const int ticks = static_cast<int>(config.age_max_s / 0.01) + config.desync_ticks + 4;
  for (int k = 0; k < ticks; ++k) network.Tick(leader, 0.01);
  for (const Estimator& node : network.nodes()) EXPECT_FALSE(node.synced());
}

TEST(EstimatorNetwork, ACycleDoesNotFeedOnItselfWhenTheLeaderIsLost) {
  const EstimatorConfig config;
  Digraph cycle(3);
  cycle.SetPin(0, 1.0);
  for (int i = 0; i < 3; ++i) cycle.SetWeight(i, (i + 2) % 3, 1.0);
  const Zeta leader = Zeta::Zero(2);
  EstimatorNetwork network(config, cycle, std::vector<Zeta>(3, leader));
  for (int k = 0; k < 50; ++k) network.Tick(leader, 0.01);
  for (const Estimator& node : network.nodes()) ASSERT_TRUE(node.synced());
  cycle.SetPin(0, 0.0);
  network.Switch(cycle);
  const int ticks = static_cast<int>(config.age_max_s / 0.01) + config.desync_ticks + 4;
  for (int k = 0; k < ticks; ++k) network.Tick(leader, 0.01);
  for (const Estimator& node : network.nodes()) EXPECT_FALSE(node.synced());
}

}  // namespace
}  // namespace armada
