#include "firmware/app/leader_news.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace armada {
namespace {

// Ages of the news, in ticks, as Estimator::Update ages them.
class News {
 public:
  explicit News(const FleetConfig& fleet)
      : ticks_each_(fleet.topologies.size() == 1
                        ? std::numeric_limits<double>::infinity()
                        : std::max(1.0, std::round(fleet.topology_period_s / fleet.timing.period_s))),
        age_(fleet.arms.size(), std::numeric_limits<double>::infinity()) {
    for (size_t k = 0; k < fleet.topologies.size(); ++k) graphs_.push_back(fleet.Graph(k));
  }

  const std::vector<double>& age() const { return age_; }

  /// Each topology in turn. The largest ages meanwhile.
  std::vector<double> Round() {
    std::vector<double> largest(age_.size(), 0.0);
    for (const Digraph& graph : graphs_) {
      // After as many ticks as there are arms the news are where they get in this topology. From then on they
      // are of the same age at each tick, or grow older with it.
      double left = ticks_each_;
      std::vector<double> before = age_;
      for (size_t k = 0; k <= age_.size() && left > 0.0; ++k, --left) {
        before = age_;
        Tick(graph);
        for (size_t i = 0; i < age_.size(); ++i) largest[i] = std::max(largest[i], age_[i]);
      }
      for (size_t i = 0; i < age_.size() && left > 0.0; ++i) {
        if (age_[i] > before[i]) age_[i] += left;
        largest[i] = std::max(largest[i], age_[i]);
      }
    }
    return largest;
  }

 private:
  void Tick(const Digraph& graph) {
    const std::vector<double> sent = age_;
    for (int i = 0; i < graph.node_count(); ++i) {
      double& own = age_[static_cast<size_t>(i)];
      if (graph.pin(i) > 0.0) own = 0.0;
      for (int j = 0; j < graph.node_count(); ++j) {
        if (graph.weight(i, j) > 0.0) own = std::min(own, sent[static_cast<size_t>(j)]);
      }
      own += 1.0;
    }
  }

  std::vector<Digraph> graphs_;
  double ticks_each_;
  std::vector<double> age_;
};

}  // namespace

std::vector<double> OldestLeaderNews(const FleetConfig& fleet) {
  News news(fleet);
  // A round brings news over one hop at least, if it brings them at all; then rounds repeat.
  for (size_t round = 0; round <= fleet.arms.size(); ++round) {
    const std::vector<double> before = news.age();
    news.Round();
    if (news.age() == before) break;
  }
  std::vector<double> oldest_s = news.Round();
  for (double& age_s : oldest_s) age_s *= fleet.timing.period_s;
  return oldest_s;
}

}  // namespace armada
