#include "host/sim/virtual_network.h"

#include <algorithm>

#include "firmware/link/channels.h"
#include "hil/random.h"

namespace armada {

VirtualNetwork::VirtualNetwork(const ScenarioConfig& scenario, uint64_t seed)
    : config_(scenario.network),
      faults_(scenario, seed),
      seed_(seed),
      period_s_(scenario.fleet.timing.period_s),
      depth_(static_cast<size_t>(scenario.network.delay_ticks + faults_.history()) + 1),
      arrival_delay_ns_(static_cast<int64_t>(scenario.fleet.link.clock.wire_time_s * 1e9)),
      listens_to_(scenario.fleet.arms.size()),
      slots_((scenario.fleet.arms.size() + 1) * depth_) {
  channels_.emplace_back(kLeaderChannel);
  ids_.push_back(0);
  for (const ArmEntry& arm : scenario.fleet.arms) {
    channels_.emplace_back(EstimateChannel(arm.id).view());
    ids_.push_back(arm.id);
  }
  const auto connect = [&](int to, size_t sender) {
    std::vector<size_t>& senders = listens_to_[static_cast<size_t>(scenario.fleet.IndexOf(to))];
    if (std::find(senders.begin(), senders.end(), sender) == senders.end()) senders.push_back(sender);
  };
  for (const Topology& topology : scenario.fleet.topologies) {
    for (const Pin& pin : topology.pins) connect(pin.arm, 0);
    for (const Edge& edge : topology.edges) {
      connect(edge.to, static_cast<size_t>(scenario.fleet.IndexOf(edge.from)) + 1);
    }
  }
}

void VirtualNetwork::Deliver(size_t receiver, int64_t k, int64_t tick_ns, ArmNode* node) {
  const int64_t sent_at = k - config_.delay_ticks;
  if (sent_at < 0) return;
  const int to = ids_[receiver + 1];
  for (const size_t sender : listens_to_[receiver]) {
    if (config_.IsLost(ids_[sender], to, static_cast<double>(sent_at) * period_s_)) continue;
    if (config_.loss > 0.0) {
      const uint64_t link = receiver * channels_.size() + sender;
      const uint64_t bits = RandomBits(seed_, kNetworkStream, link, static_cast<uint64_t>(sent_at));
      if (Uniform(bits, 0.0, 1.0) < config_.loss) continue;
    }
    const auto hand = [&](std::span<const uint8_t> payload) {
      if (!payload.empty()) node->OnMessage({channels_[sender], payload, tick_ns + arrival_delay_ns_});
    };
    if (!faults_.any()) {
      hand(Sent(sender, sent_at));
    } else if (!faults_.Loses(ids_[sender], to, sent_at)) {
      const auto past = [&](int64_t age) { return Sent(sender, sent_at - age); };
      faults_.Deliver(ids_[sender], to, sent_at, past, hand);
    }
  }
}

std::span<const uint8_t> VirtualNetwork::Sent(size_t sender, int64_t k) {
  if (k < 0) return {};
  const Slot& slot = SlotOf(sender, k);
  return {slot.buffer.data(), slot.size};
}

}  // namespace armada
