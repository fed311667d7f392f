#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/app/fleet.h"
#include "firmware/core/supervisor.h"
#include "firmware/link/lcm_endpoint.h"
#include "firmware/link/messages.h"
#include "firmware/link/seal.h"

namespace armada {

/// What came of a command to one arm.
struct CallResult {
  int arm_id = 0;
  bool heard = false;            ///< its estimates are on the link
  std::optional<reply_t> reply;  ///< to the command
  ControllerState state{};       ///< newest that it has told

  bool accepted() const { return reply && reply->refusals == 0; }
  /// For people: one line.
  std::string Describe() const;
};

/// One command to some arms of a fleet, from the first message to every arm's answer.
class OperatorCall {
 public:
  /// `arm_ids`: whom it is for. With a key it is sealed, and only sealed answers are believed.
  OperatorCall(int64_t fleet_digest, Request request, const std::vector<int>& arm_ids,
               const std::optional<FleetKey>& key);

  /// Speaks and listens until every arm has answered and, where that takes time, is where the command
  /// leads, or `timeout_s` is over.
  void Run(LcmEndpoint* link, double timeout_s);

  const std::vector<CallResult>& results() const { return results_; }
  bool all_accepted() const;

 private:
  struct Seals {
    SealCheck estimate;
    SealCheck reply;
  };

  void OnMessage(const LcmMessage& message);
  void OnEstimate(size_t index, std::span<const uint8_t> payload);
  void OnReply(size_t index, std::span<const uint8_t> payload);
  void Speak(LcmEndpoint* link);
  void Send(LcmEndpoint* link, int arm_id, int64_t heard_stamp_ns);
  bool Done() const;

  Request request_;
  int64_t fleet_digest_;
  int64_t stamp_ns_;
  std::optional<Sealer> sealer_;
  std::vector<Seals> seals_;  ///< by arm; empty without a key
  std::vector<int64_t> heard_stamp_ns_;
  std::vector<CallResult> results_;
  MessageBuffer buffer_{};
};

}  // namespace armada
