#include "host/fault/stranger.h"

#include <algorithm>
#include <limits>

#include "firmware/core/supervisor.h"
#include "firmware/link/channels.h"
#include "firmware/link/lcm_endpoint.h"
#include "firmware/link/lcm_packet.h"

namespace armada {
namespace {

constexpr size_t kMaxOversized = 8000;
constexpr const char* kNames[kJunkKinds] = {
    "random",   "short_header", "unterminated", "fragment",  "oversized", "large", "random_payload",
    "replayed", "reordered",    "damaged",      "nonfinite", "forged",    "estop"};

/// @pre there is room.
void PutBe(uint64_t value, int size, size_t at, std::vector<uint8_t>* out) {
  for (int i = size - 1; i >= 0; --i) (*out)[at++] = static_cast<uint8_t>(value >> 8 * i);
}
void PutText(std::string_view text, size_t at, std::vector<uint8_t>* out) {
  std::copy(text.begin(), text.end(), out->begin() + static_cast<std::ptrdiff_t>(at));
}

/// As whom a channel's messages are sealed; nothing where a board's neighbours do not listen.
std::optional<int> SenderOf(std::string_view channel) {
  if (channel == kLeaderChannel) return kLeaderSender;
  return ParseArmChannel(kEstimatePrefix, channel);
}

}  // namespace

const char* NameOf(JunkKind kind) {
  return kNames[static_cast<int>(kind)];
}

Stranger::Stranger(GroupSocket socket, uint64_t seed) : socket_(std::move(socket)), random_(seed) {
  for (uint8_t& byte : own_key_) byte = static_cast<uint8_t>(random_());
}

void Stranger::Listen() {
  while (const auto datagram = socket_.Receive()) {
    const auto packet = ParseLcmPacket(*datagram);
    if (!packet || packet->payload.empty()) continue;
    auto recording = std::find_if(heard_.begin(), heard_.end(),
                                  [&](const Recording& r) { return r.channel == packet->channel; });
    if (recording == heard_.end())
      recording = heard_.insert(heard_.end(), {std::string(packet->channel), {}});
    std::vector<Bytes>& payloads = recording->payloads;
    if (payloads.size() == 2) payloads.erase(payloads.begin());
    payloads.emplace_back(packet->payload.begin(), packet->payload.end());
  }
}

bool Stranger::has_heard_a_board() const {
  return std::any_of(heard_.begin(), heard_.end(), [](const Recording& recording) {
    return ParseArmChannel(kEstimatePrefix, recording.channel).has_value();
  });
}

Stranger::Bytes Stranger::RandomBytes(size_t size) {
  Bytes bytes(size);
  for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(random_());
  return bytes;
}

// be32 "LC03", sequence, size of the message, offset in it; be16 number of the fragment, count of them; in
// the first one the channel.
Stranger::Bytes Stranger::Fragment() {
  constexpr size_t kHeader = 20;
  constexpr std::string_view kChannel = "LEADER";
  const size_t least = kHeader + kChannel.size();
  const auto maybe_wild = [&](uint64_t end) { return Below(2) == 0 ? random_() : Below(end); };
  Bytes fragment = RandomBytes(least + Below(LcmEndpoint::kMaxDatagram - least + 1));
  PutText("LC03", 0, &fragment);
  PutBe(sequence_++, 4, 4, &fragment);
  PutBe(maybe_wild(10'000), 4, 8, &fragment);
  PutBe(maybe_wild(10'000), 4, 12, &fragment);
  PutBe(Below(4), 2, 16, &fragment);
  PutBe(maybe_wild(4), 2, 18, &fragment);
  if (Below(2) == 0) PutText(kChannel, kHeader, &fragment);
  return fragment;
}

void Stranger::SendRaw(JunkKind kind, const Bytes& datagram) {
  if (socket_.Send(datagram)) Count(kind);
}

void Stranger::SendOn(JunkKind kind, const std::string& channel, std::span<const uint8_t> payload) {
  Bytes datagram(kMaxOversized);
  datagram.resize(WriteLcmPacket(sequence_++, {channel, payload}, datagram));
  if (!socket_.Send(datagram)) return;
  Count(kind);
  if (kind != JunkKind::kOversized && kind != JunkKind::kLarge) ++sent_on_[channel];
}

void Stranger::Send(JunkKind kind) {
  Bytes datagram;
  switch (kind) {
    case JunkKind::kRandom:
      datagram = RandomBytes(Below(LcmEndpoint::kMaxDatagram + 1));
      if (!datagram.empty()) datagram[0] = 'X';  // no message by accident
      return SendRaw(kind, datagram);
    case JunkKind::kShortHeader:
      datagram = {'L', 'C', '0', '2'};
      datagram.resize(Below(kLcmHeaderSize));
      return SendRaw(kind, datagram);
    case JunkKind::kUnterminated:
      datagram.assign(kLcmHeaderSize + Below(200), 'E');
      PutText("LC02", 0, &datagram);
      return SendRaw(kind, datagram);
    case JunkKind::kFragment:
      return SendRaw(kind, Fragment());
    case JunkKind::kOversized:
      return SendOn(kind, "LEADER", RandomBytes(LcmEndpoint::kMaxDatagram + Below(kMaxOversized / 2)));
    case JunkKind::kLarge:
      return SendOn(kind, "NOBODY_" + std::to_string(Below(1000)),
                    RandomBytes(LcmEndpoint::kMaxDatagram - 100));
    case JunkKind::kEstop:
      return SendEstop();
    default:
      if (!heard_.empty()) SendHeard(kind);
  }
}

void Stranger::SendHeard(JunkKind kind) {
  const Recording& recording = AnyRecording();
  const Bytes& newest = recording.payloads.back();
  switch (kind) {
    case JunkKind::kRandomPayload:
      return SendOn(kind, recording.channel, RandomBytes(Below(newest.size() + 1)));
    case JunkKind::kReplayed:
      return SendOn(kind, recording.channel, newest);
    case JunkKind::kReordered:
      SendOn(kind, recording.channel, newest);
      return SendOn(kind, recording.channel, recording.payloads.front());
    case JunkKind::kDamaged:
      return SendDamaged(recording);
    default:
      if (!SendChanged<leader_t>(kind, recording) && !SendChanged<estimate_t>(kind, recording))
        SendDamaged(recording);
  }
}

void Stranger::SendDamaged(const Recording& recording) {
  Bytes damaged = recording.payloads.back();
  const uint64_t bit = Below(8 * damaged.size());
  damaged[bit / 8] ^= static_cast<uint8_t>(1 << bit % 8);
  SendOn(JunkKind::kDamaged, recording.channel, damaged);
}

void Stranger::SendEstop() {
  command_t command{};
  command.sequence = 1;
  command.request = static_cast<int8_t>(Request::kEstop);
  MessageBuffer buffer;
  Sealer sealer({own_key_, std::numeric_limits<uint64_t>::max()}, kOperatorSender);
  SendOn(JunkKind::kEstop, std::string(kCommandChannel),
         sealer.Seal(kCommandChannel, Encode(command, &buffer), &buffer));
}

/// False when the recording is no sealed message of this type.
template <class Message>
bool Stranger::SendChanged(JunkKind kind, const Recording& recording) {
  const Bytes& newest = recording.payloads.back();
  const auto sender = SenderOf(recording.channel);
  Message message;
  if (!sender || newest.size() < kSealSize) return false;
  if (!Decode(std::span(newest).first(newest.size() - kSealSize), &message)) return false;
  MessageBuffer buffer;
  if (kind == JunkKind::kNonfinite) {
    message.x_m[0] = std::numeric_limits<double>::quiet_NaN();
    Bytes changed(newest);
    const auto payload = Encode(message, &buffer);
    std::copy(payload.begin(), payload.end(), changed.begin());
    SendOn(kind, recording.channel, changed);
  } else {
    message.x_m[0] += 0.01;
    message.stamp_ns += 10'000'000;
    ++message.sequence;
    Sealer sealer({own_key_, std::numeric_limits<uint64_t>::max()}, *sender);
    SendOn(kind, recording.channel, sealer.Seal(recording.channel, Encode(message, &buffer), &buffer));
  }
  return true;
}

}  // namespace armada
