#include "firmware/core/graph.h"

#include <gtest/gtest.h>

#include "tests/core/paper_setting.h"

namespace armada {
namespace {

// Node i listens to node i - 1; node 0 to the last one too when closed.
Digraph Chain(int count, bool closed) {
  Digraph graph(count);
  for (int i = 1; i < count; ++i) graph.SetWeight(i, i - 1, 1.0);
  if (closed) graph.SetWeight(0, count - 1, 1.0);
  return graph;
}

TEST(Digraph, HasThePapersLaplacianAsPrinted) {
  constexpr int kPrinted[7][7] = {{0, 0, 0, 0, 0, 0, 0},   {-1, 2, -1, 0, 0, 0, 0}, {0, 0, 0, 0, 0, 0, 0},
                                  {-1, 0, -1, 2, 0, 0, 0}, {0, 0, 0, 0, 0, 0, 0},   {0, 0, 0, 0, -1, 1, 0},
                                  {0, 0, 0, 0, 0, 0, 0}};
  const Digraph graph = PaperGraph();
  for (int i = 0; i < 7; ++i) {
    for (int j = 0; j < 7; ++j) EXPECT_EQ(graph.Laplacian(i, j), kPrinted[i][j]) << i << "," << j;
  }
}

TEST(Digraph, LeaderReachesAllOfThePapersGraphInTwoHops) {  // (A1)
  const Digraph graph = PaperGraph();
  EXPECT_TRUE(graph.HasPin());
  EXPECT_TRUE(graph.LeaderReachesAll());
  constexpr int kDepth[7] = {1, 2, 1, 2, 1, 2, 1};
  const auto depth = graph.DepthFromLeader();
  for (int i = 0; i < 7; ++i) EXPECT_EQ(depth[static_cast<size_t>(i)], kDepth[i]);
}

TEST(Digraph, WithoutItsOnlyLinkANodeIsNotReached) {
  Digraph graph = PaperGraph();
  graph.SetWeight(5, 4, 0.0);
  EXPECT_FALSE(graph.LeaderReachesAll());
  EXPECT_EQ(graph.DepthFromLeader()[5], Digraph::kUnreachable);

  Digraph spare_link = PaperGraph();
  spare_link.SetWeight(1, 0, 0.0);  // node 2 of the paper still hears node 3
  EXPECT_TRUE(spare_link.LeaderReachesAll());
}

TEST(Digraph, LinksCarryInOneDirectionOnly) {
  Digraph graph(2);
  graph.SetPin(1, 1.0);
  graph.SetWeight(1, 0, 1.0);
  EXPECT_FALSE(graph.LeaderReachesAll());  // node 1 listens to node 0, not the other way round
  graph.SetWeight(0, 1, 1.0);
  EXPECT_TRUE(graph.LeaderReachesAll());
}

TEST(Digraph, DepthIsTheShortestPath) {
  Digraph graph = Chain(kMaxArms, false);
  graph.SetPin(0, 0.5);
  auto depth = graph.DepthFromLeader();
  for (int i = 0; i < kMaxArms; ++i) EXPECT_EQ(depth[static_cast<size_t>(i)], i + 1);
  graph.SetWeight(40, 2, 1.0);
  depth = graph.DepthFromLeader();
  EXPECT_EQ(depth[40], 4);
  EXPECT_EQ(depth[63], 27);
  EXPECT_EQ(graph.DepthFromNode(10)[9], Digraph::kUnreachable);
  EXPECT_EQ(graph.DepthFromNode(10)[10], 0);
  EXPECT_EQ(graph.DepthFromNode(10)[13], 3);
}

TEST(Digraph, WithoutPinsNothingIsReached) {
  const Digraph graph = Chain(4, true);
  EXPECT_FALSE(graph.HasPin());
  EXPECT_FALSE(graph.LeaderReachesAll());
}

TEST(Digraph, FindsASpanningTree) {  // Corollary 2
  EXPECT_TRUE(Chain(5, false).HasSpanningTree());
  EXPECT_TRUE(Chain(5, true).HasSpanningTree());
  EXPECT_TRUE(Digraph(1).HasSpanningTree());
  EXPECT_FALSE(Digraph(2).HasSpanningTree());
  EXPECT_FALSE(PaperGraph().HasSpanningTree());  // four roots: only the leader joins them

  Digraph rooted_last(3);
  rooted_last.SetWeight(0, 2, 1.0);
  rooted_last.SetWeight(1, 2, 1.0);
  EXPECT_TRUE(rooted_last.HasSpanningTree());
}

TEST(Digraph, TwoPairsApartHaveNoSpanningTree) {
  Digraph graph(4);
  graph.SetWeight(1, 0, 1.0);
  graph.SetWeight(0, 1, 1.0);
  graph.SetWeight(3, 2, 1.0);
  graph.SetWeight(2, 3, 1.0);
  EXPECT_FALSE(graph.HasSpanningTree());
  graph.SetPin(0, 1.0);
  EXPECT_FALSE(graph.LeaderReachesAll());
  graph.SetPin(3, 1.0);
  EXPECT_TRUE(graph.LeaderReachesAll());
}

TEST(Digraph, WeightsMakeTheLaplacianAndItsRowsSumToZero) {
  Digraph graph(3);
  graph.SetWeight(0, 1, 0.25);
  graph.SetWeight(0, 2, 1.5);
  graph.SetWeight(2, 0, 3.0);
  graph.SetPin(1, 0.75);
  EXPECT_EQ(graph.weight(0, 2), 1.5);
  EXPECT_EQ(graph.weight(2, 1), 0.0);
  EXPECT_EQ(graph.pin(1), 0.75);
  EXPECT_EQ(graph.Laplacian(0, 0), 1.75);
  EXPECT_EQ(graph.Laplacian(0, 2), -1.5);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(graph.Laplacian(i, 0) + graph.Laplacian(i, 1) + graph.Laplacian(i, 2), 0.0);
  }
}

}  // namespace
}  // namespace armada
