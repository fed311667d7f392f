#pragma once

#include <functional>
#include <vector>

#include "hil/scenario.h"

namespace armada {

/// What a trial does to whom, as far as its judges must know it: read from its script alone.
class TrialFacts {
 public:
  /// @pre a leader, and one topology.
  explicit TrialFacts(const ScenarioConfig& trial);

  /// Whether a fault, or an operator's request to stop, is meant for this arm.
  bool IsTouched(size_t arm) const { return touched_[arm]; }
  bool leader_touched() const { return leader_touched_; }
  bool anyone_touched() const;
  bool loses_messages() const { return loses_messages_; }
  /// Whether node `arm` has said nothing that anybody heard for all of [from_s, to_s]; -1 is the leader.
  bool IsSilent(int arm, double from_s, double to_s) const;
  /// Whether the leader's state can come to each arm, over arms that `passes` lets through.
  std::vector<bool> Reached(const std::function<bool(size_t arm)>& passes) const;

 private:
  ScenarioConfig trial_;
  std::vector<bool> touched_;
  bool leader_touched_ = false;
  bool loses_messages_ = false;
};

}  // namespace armada
