#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "firmware/link/messages.h"
#include "hil/scenario.h"

namespace armada {

/// What the scenario's faults do to the messages between the boards: some are lost, and others come that
/// nobody has sent so. The same scenario and seed give the same messages.
class LinkFaults {
 public:
  using Payload = std::span<const uint8_t>;
  /// What the sender sent `age` ticks before the one that arrives now; empty when it sent nothing.
  using Past = std::function<Payload(int64_t age)>;
  using Hand = std::function<void(Payload)>;

  LinkFaults(const ScenarioConfig& scenario, uint64_t seed);

  bool any() const { return !faults_.empty(); }
  /// Ticks that messages must be kept for, beside the newest.
  int64_t history() const;

  /// Whether what node `from` (0: the leader) sends in tick `k` does not reach arm `to`.
  bool Loses(int from, int to, int64_t k) const;
  /// Hands over all that arm `to` gets on the channel of node `from` of what was sent in tick `k`.
  void Deliver(int from, int to, int64_t k, const Past& past, const Hand& hand) const;

 private:
  double TimeOf(int64_t k) const { return static_cast<double>(k) * period_s_; }
  const FaultConfig* Find(FaultKind kind, int node, int64_t k) const {
    return FindActive(faults_, kind, node, TimeOf(k));
  }
  int64_t TicksOf(double time_s) const;
  bool IsLost(const FaultConfig& fault, int from, int to, int64_t k) const;
  void SendJunk(const FaultConfig& fault, int from, int to, int64_t k, const Hand& hand) const;

  std::vector<FaultConfig> faults_;  ///< of the link
  uint64_t seed_;
  double period_s_;
};

/// Whether messages are sealed in a run: when a fault means to get past the seals.
bool NeedsSeals(const std::vector<FaultConfig>& faults);

}  // namespace armada
