// One node: what a single Update does.
#include "firmware/core/estimator.h"

#include <gtest/gtest.h>

#include "tests/core/estimators.h"
#include "tests/core/paper_setting.h"
#include "tests/support/random_arms.h"

namespace armada {
namespace {

Zeta RandomZeta(RandomArms& random, double range = 5.0) {
  return {random.Numbers<TaskVector>(2, range), random.Numbers<TaskVector>(2, range),
          random.Numbers<TaskVector>(2, range)};
}

Zeta ZetaOf(double x_m) {
  Zeta zeta = Zeta::Zero(2);
  zeta.x_m.setConstant(x_m);
  return zeta;
}

Neighbours Hearing(std::initializer_list<Neighbour> list) {
  Neighbours neighbours;
  for (const Neighbour& neighbour : list)
    neighbours.list[static_cast<size_t>(neighbours.count++)] = neighbour;
  return neighbours;
}

Neighbour Leader(const Zeta& zeta) {
  return {1.0, zeta, 0.0, Estimator::kMaxAgreement, true};
}

double Sgn(double value) {
  return value > 0.0 ? 1.0 : value < 0.0 ? -1.0 : 0.0;
}

void ExpectEqual(const Zeta& a, const Zeta& b, double tolerance) {
  EXPECT_LE((a.x_m - b.x_m).cwiseAbs().maxCoeff(), tolerance);
  EXPECT_LE((a.v_m_s - b.v_m_s).cwiseAbs().maxCoeff(), tolerance);
  EXPECT_LE((a.a_m_s2 - b.a_m_s2).cwiseAbs().maxCoeff(), tolerance);
}

// (1.9) computed as printed, with the sum of weighted differences inside sgn.
TEST(Estimator, PaperKindIsExplicitEulerOf1_9) {
  RandomArms random(1);
  const EstimatorConfig config = ConfigOf(EstimatorKind::kPaper);
  for (int step = 0; step < 500; ++step) {
    const Zeta own = RandomZeta(random);
    Neighbours neighbours;
    neighbours.count = 1 + step % 5;
    for (int j = 0; j < neighbours.count; ++j) {
      // The age is not used: the paper knows no delay.
      neighbours.list[static_cast<size_t>(j)] = {random.In(0.1, 3.0), RandomZeta(random), 0.15, 5, true};
    }
    Zeta expected = own;
    const auto euler = [&](TaskVector Zeta::*block, double beta) {
      for (int c = 0; c < 2; ++c) {
        double sum = 0.0;
        for (int j = 0; j < neighbours.count; ++j) {
          const Neighbour& n = neighbours.list[static_cast<size_t>(j)];
          sum += n.weight * ((own.*block)[c] - (n.zeta.*block)[c]);
        }
        (expected.*block)[c] -= kPeriod_s * beta * Sgn(sum);
      }
    };
    euler(&Zeta::x_m, config.beta_1_m_s);
    euler(&Zeta::v_m_s, config.beta_2_m_s2);
    euler(&Zeta::a_m_s2, config.beta_3_m_s3);
    Estimator estimator(config, own);
    estimator.Update(neighbours, kPeriod_s);
    ExpectEqual(estimator.zeta(), expected, 0.0);
  }
}

TEST(Estimator, PaperKindChattersAroundAConstantLeader) {
  Estimator estimator(ConfigOf(EstimatorKind::kPaper), ZetaOf(1.0 + 0.3 * 4.0 * kPeriod_s));
  const Neighbours neighbours = Hearing({Leader(ZetaOf(1.0))});
  for (int k = 0; k < 10; ++k) {
    const double side = estimator.zeta().x_m[0] - 1.0;
    estimator.Update(neighbours, kPeriod_s);
    EXPECT_LT(side * (estimator.zeta().x_m[0] - 1.0), 0.0);
    EXPECT_TRUE(estimator.in_band());
  }
}

TEST(Estimator, ImplicitKindRestsExactlyOnAConstantLeader) {
  const Neighbours neighbours = Hearing({Leader(ZetaOf(1.0))});
  Estimator estimator(ConfigOf(EstimatorKind::kImplicit), ZetaOf(1.5));
  for (int k = 0; k < 20; ++k) estimator.Update(neighbours, kPeriod_s);
  for (int k = 0; k < 100; ++k) {
    estimator.Update(neighbours, kPeriod_s);
    EXPECT_EQ(estimator.zeta().x_m[0], 1.0);
    EXPECT_EQ(estimator.zeta().v_m_s[1], 0.0);
  }
}

// The implicit inclusion z+ - f in -h beta Sgn(z+ - m): its solution is unique, so meeting it is being it.
TEST(Estimator, ImplicitStepSolvesItsInclusion) {
  RandomArms random(2);
  for (int trial = 0; trial < 500; ++trial) {
    const Zeta own = RandomZeta(random, 0.5);
    const Zeta other = RandomZeta(random, 0.5);
    Estimator estimator(ConfigOf(EstimatorKind::kImplicit), own);
    estimator.Update(Hearing({Leader(other)}), kPeriod_s);
    for (int c = 0; c < 2; ++c) {
      const double moved = (estimator.zeta().a_m_s2[c] - own.a_m_s2[c]) / (kPeriod_s * 21.0);
      const double rest = estimator.zeta().a_m_s2[c] - other.a_m_s2[c];
      if (std::abs(rest) > 1e-12) {
        EXPECT_NEAR(moved, -Sgn(rest), 1e-9);
      } else {
        EXPECT_LE(std::abs(moved), 1.0 + 1e-9);
      }
    }
  }
}

TEST(Estimator, DisagreementShrinksByHBetaEveryTick) {
  const EstimatorConfig config = ConfigOf(EstimatorKind::kImplicit);
  Estimator estimator(config, ZetaOf(2.0));
  const Neighbours neighbours = Hearing({Leader(ZetaOf(1.0))});
  double distance = 1.0;
  for (int k = 0; k < 30; ++k) {
    estimator.Update(neighbours, kPeriod_s);
    distance = std::max(0.0, distance - kPeriod_s * config.beta_1_m_s);
    EXPECT_NEAR(estimator.zeta().x_m[0] - 1.0, distance, 1e-12);
  }
  EXPECT_EQ(distance, 0.0);
}

TEST(Estimator, PredictiveKindFollowsConstantAccelerationExactly) {
  Zeta leader{TaskVector{{1.0, -2.0}}, TaskVector{{0.5, 1.0}}, TaskVector{{-2.0, 3.0}}};
  const double age_s = 0.004;
  Estimator estimator(ConfigOf(EstimatorKind::kPredictive), Taylor(leader, age_s));
  for (int k = 0; k < 100; ++k) {
    Neighbour heard = Leader(leader);
    heard.age_s = age_s;  // what was sent is older than the tick
    estimator.Update(Hearing({heard}), kPeriod_s);
    leader = Taylor(leader, kPeriod_s);
    ExpectEqual(estimator.zeta(), Taylor(leader, age_s), 1e-12);
    EXPECT_TRUE(estimator.in_band());
  }
}

TEST(Estimator, MeanIsWeighted) {
  Estimator estimator(ConfigOf(EstimatorKind::kImplicit), ZetaOf(1.2));
  Neighbour far = Leader(ZetaOf(1.23));
  far.weight = 3.0;
  estimator.Update(Hearing({Leader(ZetaOf(1.19)), far}), kPeriod_s);
  EXPECT_NEAR(estimator.zeta().x_m[0], (1.19 + 3.0 * 1.23) / 4.0, 1e-15);
}

TEST(Estimator, PredictiveKindUsesTheYoungestNewsOnly) {
  const auto with_news = [](double x_m, double weight, double leader_age_s) {
    Neighbour neighbour = Leader(ZetaOf(x_m));
    neighbour.weight = weight;
    neighbour.leader_age_s = leader_age_s;
    return neighbour;
  };
  const Neighbours heard =
      Hearing({with_news(1.02, 1.0, 0.020), with_news(1.00, 3.0, 0.021), with_news(9.0, 5.0, 0.03)});
  Estimator estimator(ConfigOf(EstimatorKind::kPredictive), ZetaOf(1.0));
  estimator.Update(heard, kPeriod_s);
  EXPECT_NEAR(estimator.zeta().x_m[0], 1.005, 1e-12) << "the mean of those that are as young as any";
  EXPECT_NEAR(estimator.leader_age_s(), 0.02 + kPeriod_s, 1e-12);

  Estimator implicit(ConfigOf(EstimatorKind::kImplicit), ZetaOf(1.0));
  implicit.Update(heard, kPeriod_s);
  EXPECT_NEAR(implicit.zeta().x_m[0], 1.0 + kPeriod_s * 4.0, 1e-12)
      << "towards the mean of all, (1.9) as printed";
}

TEST(Estimator, PredictiveKindDoesNotGoBackToOlderNewsThanItsOwn) {
  Estimator estimator(ConfigOf(EstimatorKind::kPredictive), ZetaOf(1.0));
  estimator.Update(Hearing({Leader(ZetaOf(1.0))}), kPeriod_s);
  Neighbour older = Leader(ZetaOf(1.03));
  older.leader_age_s = 0.03;
  estimator.Update(Hearing({older}), kPeriod_s);
  EXPECT_EQ(estimator.zeta().x_m[0], 1.0);
  EXPECT_TRUE(estimator.in_band());
  EXPECT_NEAR(estimator.leader_age_s(), 2 * kPeriod_s, 1e-12);
}

TEST(Estimator, WhoHasOlderNewsNeedNotAgree) {
  Estimator estimator(ConfigOf(EstimatorKind::kPredictive), ZetaOf(1.0));
  Neighbour downstream = Leader(ZetaOf(5.0));
  downstream.leader_age_s = 0.05;
  downstream.agreement = 0;
  for (int k = 1; k <= 10; ++k) {
    estimator.Update(Hearing({Leader(ZetaOf(1.0)), downstream}), kPeriod_s);
    EXPECT_EQ(estimator.agreement(), k);
  }
}

TEST(Estimator, NeighboursWithoutWeightOrNotYetHeardDoNotCount) {
  for (const EstimatorKind kind : kEstimatorKinds) {
    Neighbour silent = Leader(ZetaOf(9.0));
    silent.heard = false;
    Neighbour unused = Leader(ZetaOf(9.0));
    unused.weight = 0.0;
    Estimator with(ConfigOf(kind), ZetaOf(1.1));
    Estimator without(ConfigOf(kind), ZetaOf(1.1));
    for (int k = 0; k < 5; ++k) {
      with.Update(Hearing({silent, Leader(ZetaOf(1.0)), unused}), kPeriod_s);
      without.Update(Hearing({Leader(ZetaOf(1.0))}), kPeriod_s);
    }
    ExpectEqual(with.zeta(), without.zeta(), 0.0);
  }
}

TEST(Estimator, CoastsWhenNobodyIsHeardAndIsThenInNoBand) {
  RandomArms random(3);
  const Zeta own = RandomZeta(random);
  for (const EstimatorKind kind : kEstimatorKinds) {
    Estimator estimator(ConfigOf(kind), own);
    estimator.Update(Neighbours{}, kPeriod_s);
    ExpectEqual(estimator.zeta(), kind == EstimatorKind::kPredictive ? Taylor(own, kPeriod_s) : own, 0.0);
    EXPECT_FALSE(estimator.in_band());
    EXPECT_EQ(estimator.agreement(), 0);
  }
}

TEST(Estimator, CoastOverMissedTicksIsTheOwnPrediction) {
  RandomArms random(4);
  const Zeta own = RandomZeta(random);
  for (const EstimatorKind kind : kEstimatorKinds) {
    Estimator estimator(ConfigOf(kind), own);
    estimator.Update(Neighbours{}, kPeriod_s, 0.03);
    ExpectEqual(estimator.zeta(), kind == EstimatorKind::kPredictive ? Taylor(own, 0.03 + kPeriod_s) : own,
                0.0);
  }
}

TEST(Estimator, PredictiveKindFollowsConstantJerkExactlyWhereTheLeaderTellsIt) {
  const TaskVector jerk_m_s3{{15.0, -9.0}};
  Zeta leader{TaskVector{{1.0, -2.0}}, TaskVector{{0.5, 1.0}}, TaskVector{{-2.0, 3.0}}};
  Estimator estimator(ConfigOf(EstimatorKind::kPredictive), leader);
  for (int k = 0; k < 100; ++k) {
    Neighbour heard = Leader(leader);
    heard.jerk_m_s3 = jerk_m_s3;
    estimator.Update(Hearing({heard}), kPeriod_s);
    leader = Taylor(leader, jerk_m_s3, kPeriod_s);
    ExpectEqual(estimator.zeta(), leader, 1e-12);
    EXPECT_EQ(estimator.jerk_m_s3(), jerk_m_s3);
  }
  for (int k = 0; k < 15; ++k) {  // nobody in this topology
    estimator.Update(Neighbours{}, kPeriod_s);
    leader = Taylor(leader, jerk_m_s3, kPeriod_s);
    ExpectEqual(estimator.zeta(), leader, 1e-11);
  }
}

TEST(Estimator, AJerkThatNoLeaderWithinA2HasIsNotFollowed) {
  const EstimatorConfig config = ConfigOf(EstimatorKind::kPredictive);
  Estimator estimator(config, ZetaOf(1.0));
  Neighbour wrong = Leader(ZetaOf(1.0));
  wrong.jerk_m_s3 = TaskVector{{1e9, -1e9}};
  for (int k = 0; k < 5; ++k) {
    const Zeta before = estimator.zeta();
    estimator.Update(Hearing({wrong}), kPeriod_s);
    EXPECT_EQ(estimator.jerk_m_s3(), (TaskVector{{config.beta_3_m_s3, -config.beta_3_m_s3}}));
    const TaskVector moved = estimator.zeta().a_m_s2 - before.a_m_s2;
    EXPECT_LE(moved.cwiseAbs().maxCoeff(), 2.0 * kPeriod_s * config.beta_3_m_s3 + 1e-6);
  }
}

// Topologies that reach an arm only in turn: what happened in between is corrected at the first contact.
TEST(Estimator, StaysInItsBandWhileTheNewsAreYoung) {
  const EstimatorConfig config = ConfigOf(EstimatorKind::kPredictive);
  Estimator estimator(config, ZetaOf(1.0));
  const Neighbours rest = Hearing({Leader(ZetaOf(1.0))});
  for (int k = 0; k < 6; ++k) estimator.Update(rest, kPeriod_s);
  const int news_ticks = static_cast<int>(std::lround(config.age_max_s / kPeriod_s)) - 1;
  for (int k = 0; k < news_ticks; ++k) estimator.Update(Neighbours{}, kPeriod_s);
  EXPECT_TRUE(estimator.in_band());
  EXPECT_EQ(estimator.agreement(), 6) << "what nobody confirms does not count";

  Zeta moved = ZetaOf(1.0 + 0.9 * config.beta_1_m_s * config.age_max_s);
  moved.v_m_s.setConstant(-0.9 * config.beta_2_m_s2 * config.age_max_s);
  estimator.Update(Hearing({Leader(moved)}), kPeriod_s);
  EXPECT_TRUE(estimator.in_band());
  ExpectEqual(estimator.zeta(), Taylor(moved, kPeriod_s), 1e-12);

  for (int k = 0; k < news_ticks + 2; ++k) estimator.Update(Neighbours{}, kPeriod_s);
  EXPECT_FALSE(estimator.in_band());
  EXPECT_EQ(estimator.agreement(), 0);
  estimator.Update(Hearing({Leader(ZetaOf(0.0))}), kPeriod_s);
  EXPECT_FALSE(estimator.in_band()) << "lost: from here on it returns by beta, as at the start";
}

TEST(Estimator, StandsStillAndWaitsWhenTheLeaderIsLost) {
  const EstimatorConfig config = ConfigOf(EstimatorKind::kPredictive);
  Zeta start = ZetaOf(1.0);
  start.v_m_s.setConstant(2.0);
  start.a_m_s2.setConstant(5.0);
  Estimator estimator(config, start);
  for (int k = 0; k < 6000; ++k) estimator.Update(Neighbours{}, kPeriod_s);
  const Zeta last = Taylor(start, config.age_max_s + kPeriod_s);
  EXPECT_LE((estimator.zeta().x_m - last.x_m).norm(), 0.1);
  EXPECT_TRUE(estimator.zeta().v_m_s.isZero());
  EXPECT_TRUE(estimator.zeta().a_m_s2.isZero());

  int ticks = 0;  // until it agrees with a leader at rest at 0 again
  while (!estimator.synced() && ++ticks < 1000) estimator.Update(Hearing({Leader(ZetaOf(0.0))}), kPeriod_s);
  EXPECT_LE(ticks * kPeriod_s, last.x_m[0] / config.beta_1_m_s + (config.sync_ticks + 1) * kPeriod_s);
}

TEST(Estimator, IsSyncedAfterTheConfiguredTicksInBand) {
  EstimatorConfig config = ConfigOf(EstimatorKind::kPredictive);
  config.sync_ticks = 4;
  Estimator estimator(config, ZetaOf(1.0));
  for (int k = 1; k <= 6; ++k) {
    estimator.Update(Hearing({Leader(ZetaOf(1.0))}), kPeriod_s);
    EXPECT_EQ(estimator.agreement(), k);
    EXPECT_EQ(estimator.synced(), k >= 4);
  }
}

TEST(Estimator, AgreementIsAtMostOneMoreThanUpstream) {
  Estimator estimator(ConfigOf(EstimatorKind::kImplicit), ZetaOf(1.0));
  Neighbour upstream = Leader(ZetaOf(1.0));
  for (const int theirs : {0, 0, 0, 1, 1, 7}) {
    upstream.agreement = theirs;
    estimator.Update(Hearing({Leader(ZetaOf(1.0)), upstream}), kPeriod_s);
    EXPECT_LE(estimator.agreement(), theirs + 1);
  }
  EXPECT_EQ(estimator.agreement(), 3);  // 1, 1, 1, 2, 2, then one more tick of its own
}

TEST(Estimator, IsNotSyncedWhileANeighbourInUseIsUnheard) {
  Estimator estimator(ConfigOf(EstimatorKind::kImplicit), ZetaOf(1.0));
  Neighbour silent = Leader(ZetaOf(1.0));
  silent.heard = false;
  for (int k = 0; k < 50; ++k) estimator.Update(Hearing({Leader(ZetaOf(1.0)), silent}), kPeriod_s);
  EXPECT_TRUE(estimator.in_band());
  EXPECT_FALSE(estimator.synced());
}

TEST(Estimator, StaysSyncedThroughAShortLossAndNoLonger) {
  EstimatorConfig config = ConfigOf(EstimatorKind::kPredictive);
  config.sync_ticks = 3;
  config.desync_ticks = 8;
  Estimator estimator(config, ZetaOf(1.0));
  const Neighbours leader = Hearing({Leader(ZetaOf(1.0))});
  const auto tick = [&](const Neighbours& heard, int count) {
    for (int k = 0; k < count; ++k) estimator.Update(heard, kPeriod_s);
  };
  tick(leader, config.sync_ticks);
  ASSERT_TRUE(estimator.synced());
  Neighbours lost = leader;
  lost.list[0].age_s = lost.list[0].leader_age_s = 1.001 * config.age_max_s;
  tick(lost, 4);
  EXPECT_EQ(estimator.agreement(), 0);
  tick(leader, config.sync_ticks);  // agreement is back: the count begins anew
  EXPECT_TRUE(estimator.synced());
  const int news_ticks = static_cast<int>(std::lround(config.age_max_s / kPeriod_s));
  tick(lost, news_ticks + config.desync_ticks - 2);
  EXPECT_TRUE(estimator.synced());
  tick(lost, 3);
  EXPECT_FALSE(estimator.synced());
  tick(leader, config.sync_ticks);
  EXPECT_TRUE(estimator.synced());
}

TEST(Estimator, ANeighbourSilentForTooLongIsNotHeardAnyMore) {
  const EstimatorConfig config = ConfigOf(EstimatorKind::kPredictive);
  Estimator estimator(config, ZetaOf(1.0));
  Neighbours leader = Hearing({Leader(ZetaOf(1.0))});
  for (int k = 0; k < config.sync_ticks; ++k) estimator.Update(leader, kPeriod_s);
  ASSERT_TRUE(estimator.synced());
  const auto update_at_age = [&](double age_s) {
    leader.list[0].age_s = leader.list[0].leader_age_s = age_s;
    estimator.Update(leader, kPeriod_s);
  };
  const int news_ticks = static_cast<int>(std::lround(config.age_max_s / kPeriod_s));
  for (int k = 1; k < news_ticks; ++k) update_at_age(k * kPeriod_s);
  update_at_age(config.age_max_s);
  EXPECT_GT(estimator.agreement(), 0) << "the bound itself is allowed";
  for (int k = 1; k <= config.desync_ticks; ++k) update_at_age(config.age_max_s + k * kPeriod_s);
  EXPECT_EQ(estimator.agreement(), 0);
  EXPECT_FALSE(estimator.synced());
}

TEST(Estimator, AgreementStopsAtItsMaximum) {
  Estimator estimator(ConfigOf(EstimatorKind::kImplicit), ZetaOf(0.0));
  const Neighbours leader = Hearing({Leader(ZetaOf(0.0))});
  for (int k = 0; k < Estimator::kMaxAgreement + 10; ++k) estimator.Update(leader, kPeriod_s);
  EXPECT_EQ(estimator.agreement(), Estimator::kMaxAgreement);
}

TEST(Estimator, LeaderlessStartsAtRest) {
  RandomArms random(5);
  EstimatorConfig config = ConfigOf(EstimatorKind::kPredictive);
  config.leaderless = true;
  const Zeta own = RandomZeta(random);
  const Estimator estimator(config, own);
  EXPECT_EQ(estimator.zeta().x_m, own.x_m);
  EXPECT_TRUE(estimator.zeta().v_m_s.isZero());
  EXPECT_TRUE(estimator.zeta().a_m_s2.isZero());
}

}  // namespace
}  // namespace armada
