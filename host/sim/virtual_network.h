#pragma once

#include <vector>

#include "firmware/app/arm_node.h"
#include "hil/scenario.h"
#include "host/sim/link_faults.h"

namespace armada {

/// The LCM link in virtual time: real encoded messages, delayed by whole ticks and lost at random or by a
/// link that fails, one receiver at a time, and what the scenario's faults make of them.
class VirtualNetwork {
 public:
  VirtualNetwork(const ScenarioConfig& scenario, uint64_t seed);

  /// The buffer into which a sender (0: the leader, i + 1: arm i) encodes its message of tick k.
  MessageBuffer* BufferFor(size_t sender, int64_t k) { return &SlotOf(sender, k).buffer; }
  void Send(size_t sender, int64_t k, std::span<const uint8_t> payload) {
    SlotOf(sender, k).size = payload.size();
  }

  /// Hands the messages that arrive at tick k to arm `receiver`.
  void Deliver(size_t receiver, int64_t k, int64_t tick_ns, ArmNode* node);

 private:
  struct Slot {
    MessageBuffer buffer;
    size_t size = 0;  ///< 0: nothing sent
  };
  /// What a sender sent in tick k; empty when that was nothing.
  std::span<const uint8_t> Sent(size_t sender, int64_t k);
  Slot& SlotOf(size_t sender, int64_t k) { return slots_[sender * depth_ + static_cast<size_t>(k) % depth_]; }

  NetworkConfig config_;
  LinkFaults faults_;
  uint64_t seed_;
  double period_s_;
  size_t depth_;
  int64_t arrival_delay_ns_;
  std::vector<int> ids_;                         ///< by sender; 0: the leader
  std::vector<std::string> channels_;            ///< by sender
  std::vector<std::vector<size_t>> listens_to_;  ///< by receiver: its senders
  std::vector<Slot> slots_;
};

}  // namespace armada
