#pragma once

#include <array>
#include <limits>

#include "firmware/core/parameter.h"
#include "firmware/core/zeta.h"

namespace armada {

enum class EstimatorKind {
  kPaper,       ///< explicit Euler of (1.9), as printed
  kImplicit,    ///< implicit Euler: the set-valued sgn solved exactly, no chatter
  kPredictive,  ///< implicit, around the prediction of the states to the end of the tick: fourth order in x
};

constexpr auto EnumNames(EstimatorKind) {
  using enum EstimatorKind;
  return std::to_array<EnumName<EstimatorKind>>(
      {{kPaper, "paper"}, {kImplicit, "implicit"}, {kPredictive, "predictive"}});
}

struct EstimatorConfig {
  EstimatorKind kind = EstimatorKind::kPredictive;
  double beta_1_m_s = 4.0;    ///< above sup |v_0| (A2)
  double beta_2_m_s2 = 7.0;   ///< above sup |a_0|
  double beta_3_m_s3 = 21.0;  ///< above sup |da_0/dt|
  int sync_ticks = 8;
  int desync_ticks = 20;
  double age_max_s = 0.2;
  bool leaderless = false;
  double chatter_bands = 4.0;

  void Visit(ParameterVisitor& parameter) {
    parameter({"kind", "", 0, 0, "estimator (1.9): paper (explicit Euler), implicit, predictive"}, kind);
    parameter({"beta_1_m_s", "m/s", 1e-6, 1e3, "beta_1 of (1.9), above the leader's speed per axis"},
              beta_1_m_s);
    parameter(
        {"beta_2_m_s2", "m/s^2", 1e-6, 1e4, "beta_2 of (1.9), above the leader's acceleration per axis"},
        beta_2_m_s2);
    parameter({"beta_3_m_s3", "m/s^3", 1e-6, 1e5, "beta_3 of (1.9), above the leader's jerk per axis"},
              beta_3_m_s3);
    parameter({"sync_ticks", "ticks", 1, 1000,
               "ticks of agreement, here and upstream, after which the estimate is used for motion; above "
               "the graph's depth"},
              sync_ticks);
    parameter(
        {"desync_ticks", "ticks", 1, 10000, "consecutive ticks out of the band after which it no longer is"},
        desync_ticks);
    parameter({"age_max_s", "s", 1e-3, 10,
               "a neighbour whose state, or whose news of the leader, is older counts as not heard"},
              age_max_s);
    parameter({"leaderless", "", 0, 1,
               "Corollary 2: no leader; the arms agree on a point (v = a = 0) and meet there"},
              leaderless);
    parameter({"chatter_bands", "", 1, 100,
               "paper: width of the band in steps of h beta: explicit sgn chatters by one, and so does each "
               "neighbour, while the leader moves"},
              chatter_bands);
  }
};

/// What a node last heard from one node that it listens to; the leader is one of them.
struct Neighbour {
  double weight = 0.0;  ///< eps_ij, or b_i for the leader; 0: not used now
  Zeta zeta;            ///< its state, as sent
  double age_s = 0.0;   ///< now minus the time at which the state was valid
  int agreement = 0;    ///< its agreement count; the leader's is kMaxAgreement
  bool heard = false;   ///< false until a first message has come
  double leader_age_s =
      0.0;  ///< age now of the newest leader state behind it; 0 for the leader, infinite for none
  TaskVector jerk_m_s3 = TaskVector::Zero(kMaxTaskDim);  ///< the leader's, as passed on; 0 where not known
  bool silent = false;   ///< for longer than its link's losses explain, or ever since the start
  bool stopped = false;  ///< it says that it has stopped
};

struct Neighbours {
  std::array<Neighbour, kMaxNeighbours> list;
  int count = 0;
  bool switching = false;  ///< topologies take turns: whoever is not used now may be in a moment
};

/// The networked algorithm (1.9) of one arm in discrete time. Per component c with m = sum_j w_j z_j / sum_j
/// w_j:
///   paper       zeta+ = zeta - h beta_c sgn(sum_j w_j (zeta - z_j))
///   implicit    zeta+ = m + sgn(f - m) max(0, |f - m| - h beta_c), f = zeta
///   predictive  the same with f = Taylor(zeta, h) and z_j predicted to the end of the tick. The leader's
///               jerk serves the prediction, too; every node passes on the mean of what it heard of it. Of
///               the neighbours only those with the youngest news of the leader are used, and none if this
///               node's are younger: older ones are worse predictions, and around a cycle a node's own error
///               would come back to it. What is left holds a tree from the leader, as Corollary 3 asks.
/// (Acary, Brogliato, Orlov, IEEE TAC 2012, for the implicit sgn.)
///
/// While nobody is heard the prediction goes on alone. With topologies that reach everybody only together
/// that is as it should be: as long as the news of the leader are young the estimate stays in its band, and
/// the first contact may correct it by what (A2) allows over all that time. Later it stands still and waits.
class Estimator {
 public:
  static constexpr int kMaxAgreement = 30000;

  Estimator(const EstimatorConfig& config, const Zeta& initial);

  /// One tick: from the state at the end of the last one, `missed_s` ago, to the state `h_s` from now.
  void Update(const Neighbours& neighbours, double h_s, double missed_s = 0.0);

  /// The estimate at the time of the last Update's end.
  const Zeta& zeta() const { return zeta_; }
  /// The leader's jerk as far as it has come here, for neighbours to predict by; 0 where it is not known.
  const TaskVector& jerk_m_s3() const { return jerk_m_s3_; }
  /// Every component was within its band of the neighbours' mean in the last tick.
  bool in_band() const { return in_band_; }
  /// Number of ticks for which this node, and every node up to that many hops upstream, was in its band.
  int agreement() const { return agreement_; }
  /// Age of the newest leader state behind the estimate, at the end of the tick; infinite for none. It grows
  /// hop by hop and tick by tick, so that a leader lost far away, or a cycle that feeds on itself, is noticed
  /// here.
  double leader_age_s() const { return leader_age_s_; }
  /// The estimate may be used for motion. Latched, until out of the band for `desync_ticks`; without a
  /// neighbour that counts as heard there is no band.
  bool synced() const { return synced_; }

 private:
  bool CountsAsHeard(const Neighbour& neighbour) const;
  /// Age of the newest leader state behind any neighbour; infinite for none.
  double YoungestNews(const Neighbours& neighbours) const;
  void Coast(double step_s, double leader_age_s);
  void UpdateAgreement(const Neighbours& neighbours, double used_up_to_s);

  EstimatorConfig config_;
  Zeta zeta_;
  TaskVector jerk_m_s3_;
  double coasted_s_ = 0.0;  ///< since somebody was heard
  bool in_band_ = false;
  int agreement_ = 0;
  double leader_age_s_ = std::numeric_limits<double>::infinity();
  int ticks_out_of_band_ = 0;
  bool synced_ = false;
};

}  // namespace armada
