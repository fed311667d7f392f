#include "host/campaign/trial_facts.h"

#include <algorithm>

namespace armada {
namespace {

/// Messages that nobody may believe harm nobody.
bool Harms(const FaultConfig& fault) {
  using enum FaultKind;
  return fault.kind != kReplay && fault.kind != kReorder && fault.kind != kForge && fault.kind != kJunk;
}

/// What nobody can believe is as good as silence.
bool Silences(const FaultConfig& fault) {
  using enum FaultKind;
  return fault.kind == kControllerDies || fault.kind == kControllerStops ||
         fault.kind == kControllerRestarts || fault.kind == kLeaderDies || fault.kind == kLeaderStops ||
         fault.kind == kLeaderNonfinite || fault.kind == kPartition;
}

}  // namespace

TrialFacts::TrialFacts(const ScenarioConfig& trial)
    : trial_(trial), touched_(trial.fleet.arms.size(), false) {
  for (const FaultConfig& fault : trial.faults) {
    if (!Harms(fault)) continue;
    if (fault.arm == 0) {
      leader_touched_ = true;
    } else {
      touched_[static_cast<size_t>(trial.fleet.IndexOf(fault.arm))] = true;
    }
    loses_messages_ = loses_messages_ || fault.kind == FaultKind::kLinkLoss;
  }
  for (const OperatorConfig& operation : trial.operations) {
    if (operation.request == Request::kArm || operation.request == Request::kStart) continue;
    for (size_t i = 0; i < touched_.size(); ++i) {
      if (operation.arm == 0 || operation.arm == trial.fleet.arms[i].id) touched_[i] = true;
    }
  }
}

bool TrialFacts::anyone_touched() const {
  return leader_touched_ || std::find(touched_.begin(), touched_.end(), true) != touched_.end();
}

bool TrialFacts::IsSilent(int arm, double from_s, double to_s) const {
  const int id = arm < 0 ? 0 : trial_.fleet.arms[static_cast<size_t>(arm)].id;
  return std::any_of(trial_.faults.begin(), trial_.faults.end(), [&](const FaultConfig& fault) {
    return fault.arm == id && Silences(fault) && fault.at_s <= from_s && to_s < fault.until_s;
  });
}

std::vector<bool> TrialFacts::Reached(const std::function<bool(size_t)>& passes) const {
  const Topology& topology = trial_.fleet.topologies.front();
  std::vector<bool> reached(touched_.size(), false);
  for (const Pin& pin : topology.pins) reached[static_cast<size_t>(trial_.fleet.IndexOf(pin.arm))] = true;
  for (bool grown = true; grown;) {
    grown = false;
    for (const Edge& edge : topology.edges) {
      const auto from = static_cast<size_t>(trial_.fleet.IndexOf(edge.from));
      const auto to = static_cast<size_t>(trial_.fleet.IndexOf(edge.to));
      if (!reached[from] || reached[to] || !passes(from)) continue;
      reached[to] = grown = true;
    }
  }
  return reached;
}

}  // namespace armada
