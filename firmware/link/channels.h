#pragma once

#include <array>
#include <charconv>
#include <cstddef>
#include <optional>
#include <string_view>

#include "firmware/core/types.h"

namespace armada {

/// Names of at most 15 characters stay inside a std::string, without a heap, in every LCM tool.
inline constexpr size_t kMaxChannelName = 15;

inline constexpr std::string_view kLeaderChannel = "LEADER";
inline constexpr std::string_view kEstimatePrefix = "EST_";
inline constexpr std::string_view kTelemetryPrefix = "TEL_";
inline constexpr std::string_view kReplyPrefix = "ACK_";
inline constexpr std::string_view kCommandChannel = "CMD";

/// The name of one arm's channel, <prefix><arm id>, in fixed storage.
class ArmChannel {
 public:
  /// @pre `prefix` is one of the above and 1 <= arm_id <= kMaxArms.
  ArmChannel(std::string_view prefix, int arm_id) : size_(prefix.copy(name_.data(), prefix.size())) {
    const auto end = std::to_chars(name_.data() + size_, name_.data() + name_.size(), arm_id).ptr;
    size_ = static_cast<size_t>(end - name_.data());
  }

  std::string_view view() const { return {name_.data(), size_}; }
  operator std::string_view() const { return view(); }  // NOLINT(google-explicit-constructor): it is a name

 private:
  std::array<char, kMaxChannelName> name_{};
  size_t size_;
};

inline ArmChannel EstimateChannel(int arm_id) {
  return {kEstimatePrefix, arm_id};
}
inline ArmChannel TelemetryChannel(int arm_id) {
  return {kTelemetryPrefix, arm_id};
}
inline ArmChannel ReplyChannel(int arm_id) {
  return {kReplyPrefix, arm_id};
}

/// The arm whose channel of that prefix this is; nothing when it is another's, or not written as ArmChannel
/// does it.
inline std::optional<int> ParseArmChannel(std::string_view prefix, std::string_view channel) {
  if (channel.substr(0, prefix.size()) != prefix) return std::nullopt;
  const std::string_view digits = channel.substr(prefix.size());
  int arm_id = 0;
  const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), arm_id);
  if (code != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
  if (arm_id < 1 || arm_id > kMaxArms || digits.front() == '0') return std::nullopt;
  return arm_id;
}

}  // namespace armada
