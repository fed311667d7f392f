#include "hil/estimate_bound.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "hil/leader_path.h"
#include "hil/start_state.h"

namespace armada {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Bounds on |x_hat - x_0|, and of v, a and jerk, on any axis.
using Deviations = std::array<double, 4>;

/// What one node knows, and tells.
struct Node {
  Deviations error{};
  double leader_age_s = kInfinity;
};

/// The last message of one node to another.
struct Link {
  size_t sender = 0;                                         ///< 0: the leader, i + 1: arm i
  std::array<double, TopologySchedule::kMaxCount> weight{};  ///< by topology
  Node message;
  double stamp_s = -kInfinity;
};

class BoundRecursion {
 public:
  explicit BoundRecursion(const ScenarioConfig& scenario)
      : scenario_(scenario),
        estimator_(scenario.fleet.estimator),
        h_s_(scenario.fleet.timing.period_s),
        leader_(LeaderPath(scenario.leader).Bounds()),
        // A constant delay looks like an offset of the clocks, unless there is one clock for all.
        unseen_s_(scenario.fleet.link.shared_clock ? 0.0 : scenario.network.delay_ticks * h_s_),
        sent_(static_cast<size_t>(scenario.network.delay_ticks) + 1) {
    const auto start = LargestStartErrors(scenario.start, LeaderPath(scenario.leader));
    arms_.resize(scenario.fleet.arms.size());
    for (Arm& arm : arms_) arm.error = {start[0], start[1], start[2], leader_.jerk_m_s3};
    for (size_t k = 0; k < scenario.fleet.topologies.size(); ++k) {
      for (const Pin& pin : scenario.fleet.topologies[k].pins) LinkOf(pin.arm, 0).weight[k] = pin.weight;
      for (const Edge& edge : scenario.fleet.topologies[k].edges)
        LinkOf(edge.to, edge.from).weight[k] = edge.weight;
    }
  }

  /// One tick: from the estimates at its start to those at its end.
  void Tick(int64_t k) {
    Deliver(k);
    const double t_s = static_cast<double>(k) * h_s_;
    const size_t topology = scenario_.fleet.Schedule().At(t_s);
    for (Arm& arm : arms_) Update(t_s, topology, &arm);
  }

  EstimateBound Of(size_t arm) const {
    const Deviations& error = arms_[arm].error;
    return {error[0], error[1], error[2]};
  }

 private:
  struct Arm : Node {
    std::vector<Link> links;
    double coasted_s = 0.0;
  };

  Link& LinkOf(int to, int from) {
    std::vector<Link>& links = arms_[static_cast<size_t>(scenario_.fleet.IndexOf(to))].links;
    const size_t sender = from == 0 ? 0 : static_cast<size_t>(scenario_.fleet.IndexOf(from)) + 1;
    const auto known =
        std::find_if(links.begin(), links.end(), [&](const Link& link) { return link.sender == sender; });
    if (known != links.end()) return *known;
    links.emplace_back().sender = sender;
    return links.back();
  }

  void Deliver(int64_t k) {
    std::vector<Node>& sent = sent_[static_cast<size_t>(k) % sent_.size()];
    sent.clear();
    for (const Arm& arm : arms_) sent.push_back({arm.error, arm.leader_age_s});
    const int64_t sent_at = k - scenario_.network.delay_ticks;
    if (sent_at < 0) return;
    const double t_s = static_cast<double>(sent_at) * h_s_;
    for (size_t i = 0; i < arms_.size(); ++i) {
      for (Link& link : arms_[i].links) {
        if (scenario_.network.IsLost(IdOf(link.sender), IdOf(i + 1), t_s)) continue;
        if (link.sender == 0) {
          const double rate_hz = scenario_.leader.rate_hz;  // the newest state on the leader's own grid
          link.stamp_s = std::floor(t_s * rate_hz + 1e-6) / rate_hz;
          link.message = {Deviations{}, 0.0};
        } else {
          link.stamp_s = t_s;
          link.message = sent_[static_cast<size_t>(sent_at) % sent_.size()][link.sender - 1];
        }
      }
    }
  }

  int IdOf(size_t node) const { return node == 0 ? 0 : scenario_.fleet.arms[node - 1].id; }

  double AgeOf(const Link& link, double t_s) const { return t_s - link.stamp_s - unseen_s_; }
  double LeaderAge(const Link& link, double t_s) const {
    return link.message.leader_age_s + AgeOf(link, t_s);
  }
  bool CountsAsHeard(const Link& link, double t_s, size_t topology) const {
    return link.weight[topology] > 0.0 &&
           std::max(AgeOf(link, t_s), LeaderAge(link, t_s)) <= estimator_.age_max_s;
  }

  // Estimator::Update on bounds.
  void Update(double t_s, size_t topology, Arm* arm) const {
    double youngest_s = arm->leader_age_s;
    for (const Link& link : arm->links) {
      if (CountsAsHeard(link, t_s, topology)) youngest_s = std::min(youngest_s, LeaderAge(link, t_s));
    }
    Deviations sum{};
    double degree = 0.0;
    for (const Link& link : arm->links) {
      if (!CountsAsHeard(link, t_s, topology) || LeaderAge(link, t_s) > youngest_s + 0.5 * h_s_) continue;
      const Deviations z = Ahead(Outdated(link.message.error), AgeOf(link, t_s) + h_s_);
      for (size_t c = 0; c < z.size(); ++c) sum[c] += link.weight[topology] * z[c];
      degree += link.weight[topology];
    }
    arm->leader_age_s = youngest_s + h_s_;
    degree > 0.0 ? Correct(sum, degree, arm) : Coast(arm);
  }

  // The estimate lands on the mean, or between it and the own prediction, which it left by beta.
  void Correct(const Deviations& sum, double degree, Arm* arm) const {
    const Deviations f = AheadWithoutJerk(arm->error, h_s_);
    const double since_s = h_s_ + (arm->coasted_s <= estimator_.age_max_s ? arm->coasted_s : 0.0);
    // The jerk is the mean's.
    const Deviations moved = {since_s * estimator_.beta_1_m_s, since_s * estimator_.beta_2_m_s2,
                              since_s * estimator_.beta_3_m_s3, kInfinity};
    for (size_t c = 0; c < sum.size(); ++c) arm->error[c] = std::max(sum[c] / degree, f[c] - moved[c]);
    arm->coasted_s = 0.0;
  }

  void Coast(Arm* arm) const {
    arm->coasted_s += h_s_;
    arm->error = Ahead(arm->error, h_s_);
    if (arm->coasted_s <= estimator_.age_max_s) return;
    arm->error = {arm->error[0], leader_.v_m_s, leader_.a_m_s2, leader_.jerk_m_s3};  // it stands still
  }

  // The bounds of a prediction over `t_s`, whose jerk drifts off by the snap, or at most from one extreme to
  // the other.
  Deviations Ahead(const Deviations& e, double t_s) const {
    return Predict(e, t_s, leader_.snap_m_s4, 2.0 * leader_.jerk_m_s3);
  }
  // Of one that takes the jerk for 0.
  Deviations AheadWithoutJerk(const Deviations& e, double t_s) const {
    return Predict({e[0], e[1], e[2], leader_.jerk_m_s3}, t_s, 0.0, leader_.jerk_m_s3);
  }
  static Deviations Predict(const Deviations& e, double t_s, double snap_m_s4, double jerk_max_m_s3) {
    const double t2 = t_s * t_s / 2.0;
    const double t3 = t2 * t_s / 3.0;
    const double t4 = t3 * t_s / 4.0;
    return {e[0] + t_s * e[1] + t2 * e[2] + std::min(t3 * e[3] + t4 * snap_m_s4, t3 * jerk_max_m_s3),
            e[1] + t_s * e[2] + std::min(t2 * e[3] + t3 * snap_m_s4, t2 * jerk_max_m_s3),
            e[2] + std::min(t_s * e[3] + t2 * snap_m_s4, t_s * jerk_max_m_s3),
            std::min(e[3] + t_s * snap_m_s4, jerk_max_m_s3)};
  }

  // Of a state that is older than its receiver can see.
  Deviations Outdated(const Deviations& e) const {
    if (unseen_s_ <= 0.0) return e;
    return {e[0] + unseen_s_ * leader_.v_m_s, e[1] + unseen_s_ * leader_.a_m_s2,
            e[2] + unseen_s_ * leader_.jerk_m_s3,
            std::min(e[3] + unseen_s_ * leader_.snap_m_s4, 2.0 * leader_.jerk_m_s3)};
  }

  const ScenarioConfig& scenario_;
  const EstimatorConfig& estimator_;
  double h_s_;
  LeaderBounds leader_;
  double unseen_s_;
  std::vector<Arm> arms_;
  std::vector<std::vector<Node>> sent_;  ///< by tick, for as long as messages are under way
};

}  // namespace

std::optional<std::vector<EstimateBound>> BoundEstimates(const ScenarioConfig& scenario) {
  if (scenario.leader.kind == LeaderKind::kNone || scenario.network.loss > 0.0 ||
      scenario.fleet.estimator.kind != EstimatorKind::kPredictive) {
    return std::nullopt;
  }
  BoundRecursion recursion(scenario);
  std::vector<EstimateBound> largest(scenario.fleet.arms.size());
  const int64_t ticks = std::llround(scenario.seconds / scenario.fleet.timing.period_s);
  for (int64_t k = 0; k < ticks; ++k) {
    recursion.Tick(k);
    if (static_cast<double>(k) * scenario.fleet.timing.period_s < scenario.window_start_s) continue;
    for (size_t i = 0; i < largest.size(); ++i) {
      const EstimateBound now = recursion.Of(i);
      largest[i] = {std::max(largest[i].x_m, now.x_m), std::max(largest[i].v_m_s, now.v_m_s),
                    std::max(largest[i].a_m_s2, now.a_m_s2)};
    }
  }
  return largest;
}

}  // namespace armada
