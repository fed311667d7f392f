#include "host/sim/link_faults.h"

#include <algorithm>
#include <cmath>

#include "firmware/link/seal.h"
#include "hil/random.h"

namespace armada {
namespace {

bool IsOfLink(FaultKind kind) {
  switch (kind) {
    case FaultKind::kLinkLoss:
    case FaultKind::kPartition:
    case FaultKind::kReplay:
    case FaultKind::kReorder:
    case FaultKind::kForge:
    case FaultKind::kJunk:
      return true;
    default:
      return false;
  }
}

/// A number for the way from one node to another.
uint64_t LinkNumber(int from, int to) {
  constexpr uint64_t kNodes = kMaxArms + 1;
  return static_cast<uint64_t>(from) * kNodes + static_cast<uint64_t>(to);
}

/// The message with its position moved and the seal that it had.
template <class Message>
LinkFaults::Payload Moved(LinkFaults::Payload sealed, double distance_m, MessageBuffer* buffer) {
  Message message;
  if (sealed.size() < kSealSize || !Decode(sealed.first(sealed.size() - kSealSize), &message)) return {};
  for (int i = 0; i < message.task_dim; ++i) message.x_m[i] += distance_m;
  const size_t size = Encode(message, buffer).size();
  const LinkFaults::Payload seal = sealed.last(kSealSize);
  std::copy(seal.begin(), seal.end(), buffer->begin() + static_cast<std::ptrdiff_t>(size));
  return LinkFaults::Payload(*buffer).first(size + kSealSize);
}

}  // namespace

bool NeedsSeals(const std::vector<FaultConfig>& faults) {
  return std::any_of(faults.begin(), faults.end(), [](const FaultConfig& fault) {
    return fault.kind == FaultKind::kForge || fault.kind == FaultKind::kReplay;
  });
}

LinkFaults::LinkFaults(const ScenarioConfig& scenario, uint64_t seed)
    : seed_(seed), period_s_(scenario.fleet.timing.period_s) {
  for (const FaultConfig& fault : scenario.faults) {
    if (IsOfLink(fault.kind)) faults_.push_back(fault);
  }
}

int64_t LinkFaults::TicksOf(double time_s) const {
  return std::max<int64_t>(1, std::llround(time_s / period_s_));
}

int64_t LinkFaults::history() const {
  int64_t ticks = 0;
  for (const FaultConfig& fault : faults_) {
    if (fault.kind == FaultKind::kReplay) ticks = std::max(ticks, TicksOf(fault.value));
    if (fault.kind == FaultKind::kReorder) ticks = std::max<int64_t>(ticks, 1);
  }
  return ticks;
}

bool LinkFaults::Loses(int from, int to, int64_t k) const {
  return std::any_of(faults_.begin(), faults_.end(), [&](const FaultConfig& fault) {
    return (fault.arm == from || fault.arm == to) && fault.IsActive(TimeOf(k)) && IsLost(fault, from, to, k);
  });
}

bool LinkFaults::IsLost(const FaultConfig& fault, int from, int to, int64_t k) const {
  if (fault.kind == FaultKind::kPartition) return true;
  if (fault.kind != FaultKind::kLinkLoss) return false;
  const uint64_t bits =
      RandomBits(Mix(seed_ ^ kFaultStream), kNetworkStream, LinkNumber(from, to), static_cast<uint64_t>(k));
  return Uniform(bits, 0.0, 1.0) < fault.value;
}

// What is false comes before what is true: a receiver that took it would refuse the rest.
void LinkFaults::Deliver(int from, int to, int64_t k, const Past& past, const Hand& hand) const {
  MessageBuffer buffer;
  if (const FaultConfig* const junk = Find(FaultKind::kJunk, from, k)) SendJunk(*junk, from, to, k, hand);
  if (const FaultConfig* const forge = Find(FaultKind::kForge, from, k)) {
    hand(from == 0 ? Moved<leader_t>(past(0), forge->value, &buffer)
                   : Moved<estimate_t>(past(0), forge->value, &buffer));
  }
  if (Find(FaultKind::kReorder, from, k) == nullptr) {
    hand(past(0));
  } else if (k % 2 == 1) {
    hand(past(0));
    hand(past(1));
  }
  if (const FaultConfig* const replay = Find(FaultKind::kReplay, from, k)) {
    hand(past(TicksOf(replay->value)));
  }
}

void LinkFaults::SendJunk(const FaultConfig& fault, int from, int to, int64_t k, const Hand& hand) const {
  const auto until = [&](int64_t ticks) {
    return std::llround(fault.value * period_s_ * static_cast<double>(ticks));
  };
  std::array<uint8_t, 256> bytes;
  for (int64_t i = until(k); i < until(k + 1); ++i) {
    uint64_t bits = RandomBits(seed_, kFaultStream, LinkNumber(from, to), static_cast<uint64_t>(i));
    const size_t size = bits % (bytes.size() + 1);
    for (size_t at = 0; at < size; ++at) {
      if (at % 8 == 0) bits = Mix(bits);
      bytes[at] = static_cast<uint8_t>(bits >> 8 * (at % 8));
    }
    hand(Payload(bytes).first(size));
  }
}

}  // namespace armada
