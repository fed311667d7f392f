#include "firmware/app/operator_desk.h"

#include "firmware/link/channels.h"

namespace armada {
namespace {

bool IsSame(const reply_t& reply, const command_t& command) {
  return reply.command_stamp_ns == command.stamp_ns && reply.command_sequence == command.sequence &&
         reply.request == command.request;
}

}  // namespace

OperatorDesk::OperatorDesk(int arm_id, const std::optional<LinkIdentity>& identity, int64_t fleet_digest,
                           double age_max_s)
    : arm_id_(arm_id), fleet_digest_(fleet_digest), age_max_ns_(static_cast<int64_t>(1e9 * age_max_s)) {
  if (identity) seal_.emplace(identity->key, kOperatorSender);
}

void OperatorDesk::OnMessage(const LcmMessage& message) {
  if (message.channel != kCommandChannel) return;
  std::span<const uint8_t> payload = message.payload;
  if (seal_) {
    SealCheck seal = *seal_;
    if (seal.Open(message.channel, &payload) != SealVerdict::kGenuine) {
      ++rejected_;
      return;
    }
  }
  command_t command{};
  if (!Decode(payload, &command)) {
    ++rejected_;
    return;
  }
  const bool estop = command.request == static_cast<int>(Request::kEstop);
  if (command.arm_id != arm_id_ && !(command.arm_id == 0 && estop)) return;
  if (IsSame(reply_, command)) {
    reply_due_ = true;  // sent again: its reply was lost
    if (!estop) return;
  }
  // Nothing overtakes an e-stop, and nothing recorded a command that is newer.
  const bool pending_estop = pending_ && pending_->request == static_cast<int>(Request::kEstop);
  const bool older = pending_ && command.heard_stamp_ns < pending_->heard_stamp_ns;
  if (estop || (!pending_estop && !older)) pending_ = command;
}

Request OperatorDesk::TakeRequest(int64_t tick_ns) {
  if (!pending_) return Request::kNone;
  const command_t& command = *pending_;
  const auto request = static_cast<Request>(command.request);
  refused_here_ = 0;
  if (request != Request::kEstop) {
    const int64_t age_ns = tick_ns - command.heard_stamp_ns;
    // Estimates are stamped for the end of the tick in which they are made.
    const bool fresh = age_ns < age_max_ns_ && age_ns > -age_max_ns_ && command.heard_stamp_ns > quoted_ns_;
    if (!fresh) refused_here_ |= Bit(Refusal::kStale);
    if (command.fleet_digest != fleet_digest_) refused_here_ |= Bit(Refusal::kFleetDiffers);
    if (fresh) quoted_ns_ = command.heard_stamp_ns;
  }
  // A hold is not refused over a file.
  if (request == Request::kHold) refused_here_ &= ~Bit(Refusal::kFleetDiffers);
  return refused_here_ == 0 ? request : Request::kNone;
}

void OperatorDesk::Answer(Refusals refusals, ControllerState state, Cause cause) {
  if (!pending_) return;
  reply_.arm_id = static_cast<int8_t>(arm_id_);
  reply_.request = pending_->request;
  reply_.command_stamp_ns = pending_->stamp_ns;
  reply_.command_sequence = pending_->sequence;
  reply_.refusals = static_cast<int32_t>(refusals | refused_here_);
  reply_.state = static_cast<int8_t>(state);
  reply_.cause = static_cast<int8_t>(cause);
  reply_due_ = true;
  pending_.reset();
}

std::optional<reply_t> OperatorDesk::TakeReply(int64_t tick_ns) {
  if (!reply_due_) return std::nullopt;
  reply_due_ = false;
  reply_.stamp_ns = tick_ns;
  reply_.sequence = ++replies_;
  return reply_;
}

}  // namespace armada
