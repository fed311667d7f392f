#pragma once

#include <optional>

#include "firmware/core/supervisor.h"
#include "firmware/link/lcm_message.h"
#include "firmware/link/messages.h"
#include "firmware/link/seal.h"

namespace armada {

/// Where a board takes an operator's commands. A command counts once, and only if it quotes a stamp that this
/// board has sent within the last `age_max_s` and later than the one before: what was recorded earlier,
/// before a restart or a moment ago, is worth nothing. An e-stop always counts.
class OperatorDesk {
 public:
  OperatorDesk(int arm_id, const std::optional<LinkIdentity>& identity, int64_t fleet_digest,
               double age_max_s);

  /// Takes a message if it is a genuine command for this arm.
  void OnMessage(const LcmMessage& message);

  /// The request to be judged in this tick. Asked once a tick.
  Request TakeRequest(int64_t tick_ns);
  /// What came of it; a reply is then due.
  void Answer(Refusals refusals, ControllerState state, Cause cause);

  /// The reply that is due, once; nothing when none is.
  std::optional<reply_t> TakeReply(int64_t tick_ns);

  int64_t rejected() const { return rejected_; }

 private:
  int arm_id_;
  int64_t fleet_digest_;
  int64_t age_max_ns_;
  std::optional<SealCheck> seal_;  ///< of a sender that was never heard: order is the desk's matter
  std::optional<command_t> pending_;
  Refusals refused_here_ = 0;
  reply_t reply_{};
  bool reply_due_ = false;
  int64_t quoted_ns_ = 0;  ///< by the newest command that counted
  int64_t replies_ = 0;
  int64_t rejected_ = 0;
};

}  // namespace armada
