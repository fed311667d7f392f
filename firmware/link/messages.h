#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "armada/command_t.hpp"
#include "armada/estimate_t.hpp"
#include "armada/leader_t.hpp"
#include "armada/reply_t.hpp"
#include "armada/telemetry_t.hpp"

namespace armada {

/// Storage for any encoded message.
using MessageBuffer = std::array<uint8_t, 1024>;

/// 146 years: stamps beyond it are refused, so that differences of times never overflow.
inline constexpr int64_t kMaxStampNs = int64_t{1} << 62;

/// The encoded message, inside `buffer`. Not checked: a receiver refuses what is not valid.
std::span<const uint8_t> Encode(const leader_t& message, MessageBuffer* buffer);
std::span<const uint8_t> Encode(const estimate_t& message, MessageBuffer* buffer);
std::span<const uint8_t> Encode(const telemetry_t& message, MessageBuffer* buffer);
std::span<const uint8_t> Encode(const command_t& message, MessageBuffer* buffer);
std::span<const uint8_t> Encode(const reply_t& message, MessageBuffer* buffer);

/// Decodes and checks. False, with `*message` in any state, unless the length and the type's fingerprint fit,
/// every number is finite, the stamp is in 0 to kMaxStampNs, the sequence is at least 1, and task_dim,
/// arm_id, dof, agreement, parameter_count, states, causes and requests are in their ranges. None allocates.
bool Decode(std::span<const uint8_t> payload, leader_t* message);
bool Decode(std::span<const uint8_t> payload, estimate_t* message);
bool Decode(std::span<const uint8_t> payload, telemetry_t* message);
bool Decode(std::span<const uint8_t> payload, command_t* message);
bool Decode(std::span<const uint8_t> payload, reply_t* message);

}  // namespace armada
