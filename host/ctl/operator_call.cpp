#include "host/ctl/operator_call.h"

#include <poll.h>

#include <algorithm>
#include <ctime>

#include "firmware/app/realtime.h"
#include "firmware/core/cause.h"
#include "firmware/link/channels.h"

namespace armada {
namespace {

constexpr int64_t kSpeakEveryNs = 50'000'000;

int64_t WallNow() {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

// Whether an arm is on its way to where an accepted request leads.
bool IsUnderWay(Request request, ControllerState state) {
  return request == Request::kArm &&
         (state == ControllerState::kMonitor || state == ControllerState::kArming);
}

}  // namespace

std::string CallResult::Describe() const {
  std::string text = "arm " + std::to_string(arm_id) + ": ";
  if (!heard && !reply) return text + "not heard";
  if (!reply) return text + "no answer; it is in " + NameOf(state);
  if (accepted()) return text + NameOf(state);
  text += "refused";
  const char* separator = ": ";
  for (int i = 0; i < kRefusals; ++i) {
    const auto refusal = static_cast<Refusal>(i);
    if ((static_cast<Refusals>(reply->refusals) & Bit(refusal)) == 0) continue;
    text += separator + std::string(TextOf(refusal));
    separator = "; ";
  }
  text += std::string(" (") + NameOf(static_cast<ControllerState>(reply->state));
  const auto cause = static_cast<Cause>(reply->cause);
  if (cause != Cause::kNone) text += std::string(", ") + NameOf(cause);
  return text + ")";
}

OperatorCall::OperatorCall(int64_t fleet_digest, Request request, const std::vector<int>& arm_ids,
                           const std::optional<FleetKey>& key)
    : request_(request),
      fleet_digest_(fleet_digest),
      stamp_ns_(WallNow()),
      heard_stamp_ns_(arm_ids.size(), 0) {
  if (key) sealer_.emplace(LinkIdentity{*key, static_cast<uint64_t>(stamp_ns_)}, kOperatorSender);
  for (const int id : arm_ids) {
    results_.push_back({.arm_id = id, .heard = false, .reply = std::nullopt});
    if (key) seals_.push_back({SealCheck(*key, id), SealCheck(*key, id)});
  }
}

void OperatorCall::Run(LcmEndpoint* link, double timeout_s) {
  const int64_t end_ns = MonotonicNow() + static_cast<int64_t>(timeout_s * 1e9);
  int64_t next_ns = MonotonicNow();
  while (!Done() && MonotonicNow() < end_ns) {
    link->Drain([&](const LcmMessage& message) { OnMessage(message); });
    if (MonotonicNow() >= next_ns) {
      Speak(link);
      next_ns = MonotonicNow() + kSpeakEveryNs;
    }
    pollfd input{link->descriptor(), POLLIN, 0};
    poll(&input, 1, 5);
  }
}

bool OperatorCall::all_accepted() const {
  return std::all_of(results_.begin(), results_.end(), [](const CallResult& r) { return r.accepted(); });
}

bool OperatorCall::Done() const {
  return std::all_of(results_.begin(), results_.end(), [&](const CallResult& result) {
    return result.reply && (!result.accepted() || !IsUnderWay(request_, result.state));
  });
}

// An e-stop is for all at once and waits for nobody. The rest quotes what each arm has just said.
void OperatorCall::Speak(LcmEndpoint* link) {
  for (size_t i = 0; i < results_.size(); ++i) {
    if (results_[i].reply) continue;
    if (request_ == Request::kEstop || results_[i].heard) Send(link, results_[i].arm_id, heard_stamp_ns_[i]);
  }
}

void OperatorCall::Send(LcmEndpoint* link, int arm_id, int64_t heard_stamp_ns) {
  command_t command{};
  command.stamp_ns = stamp_ns_;
  command.sequence = 1;
  command.arm_id = static_cast<int8_t>(arm_id);
  command.request = static_cast<int8_t>(request_);
  command.heard_stamp_ns = heard_stamp_ns;
  command.fleet_digest = fleet_digest_;
  link->Publish(kCommandChannel, SealIfKeyed(sealer_, kCommandChannel, Encode(command, &buffer_), &buffer_));
}

void OperatorCall::OnMessage(const LcmMessage& message) {
  for (size_t i = 0; i < results_.size(); ++i) {
    const int id = results_[i].arm_id;
    const bool estimate = ParseArmChannel(kEstimatePrefix, message.channel) == id;
    const bool reply = ParseArmChannel(kReplyPrefix, message.channel) == id;
    if (!estimate && !reply) continue;
    std::span<const uint8_t> payload = message.payload;
    if (!seals_.empty()) {
      SealCheck& seal = estimate ? seals_[i].estimate : seals_[i].reply;
      if (seal.Open(message.channel, &payload) != SealVerdict::kGenuine) return;
    }
    return estimate ? OnEstimate(i, payload) : OnReply(i, payload);
  }
}

void OperatorCall::OnEstimate(size_t index, std::span<const uint8_t> payload) {
  estimate_t estimate{};
  if (!Decode(payload, &estimate) || estimate.arm_id != results_[index].arm_id) return;
  results_[index].heard = true;
  results_[index].state = static_cast<ControllerState>(estimate.state);
  heard_stamp_ns_[index] = estimate.stamp_ns;
}

void OperatorCall::OnReply(size_t index, std::span<const uint8_t> payload) {
  reply_t reply{};
  if (!Decode(payload, &reply) || reply.arm_id != results_[index].arm_id) return;
  if (reply.command_stamp_ns != stamp_ns_ || reply.request != static_cast<int8_t>(request_)) return;
  results_[index].reply = reply;
  results_[index].state = static_cast<ControllerState>(reply.state);
}

}  // namespace armada
