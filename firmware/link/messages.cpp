#include "firmware/link/messages.h"

#include <algorithm>
#include <cmath>

#include "firmware/core/supervisor.h"
#include "firmware/core/types.h"

namespace armada {
namespace {

static_assert(std::size(telemetry_t{}.q_rad) == kMaxDof);
static_assert(std::size(telemetry_t{}.theta_hat) == kMaxParameters);
static_assert(std::size(estimate_t{}.x_m) == kMaxTaskDim);

template <class Message>
std::span<const uint8_t> EncodeAny(const Message& message, MessageBuffer* buffer) {
  const int size = message.encode(buffer->data(), 0, static_cast<int>(buffer->size()));
  return std::span(*buffer).first(static_cast<size_t>(std::max(size, 0)));
}

template <class Message>
bool DecodeAny(std::span<const uint8_t> payload, Message* message) {
  const auto size = static_cast<size_t>(message->getEncodedSize());
  return payload.size() == size && message->decode(payload.data(), 0, static_cast<int>(size)) >= 0;
}

template <class... Values>
bool AreFinite(const Values&... values) {
  return (std::isfinite(values) && ...);
}

template <size_t kSize>
bool AreFinite(const double (&values)[kSize]) {
  return std::all_of(values, values + kSize, [](double value) { return std::isfinite(value); });
}

bool IsIn(int value, int min, int max) {
  return min <= value && value <= max;
}

// What all messages have in common.
template <class Message>
bool HasValidHeader(const Message& message) {
  return message.stamp_ns >= 0 && message.stamp_ns <= kMaxStampNs && message.sequence >= 1;
}

template <class Message>
bool HasTaskDim(const Message& message) {
  return IsIn(message.task_dim, 2, kMaxTaskDim);
}

bool IsState(int state) {
  return IsIn(state, 0, kControllerStates - 1);
}

// A state zeta = col(x, v, a) of the leader or of an estimate, and the leader's jerk.
template <class Message>
bool HasFiniteState(const Message& message) {
  return AreFinite(message.x_m) && AreFinite(message.v_m_s) && AreFinite(message.a_m_s2) &&
         AreFinite(message.jerk_m_s3);
}

}  // namespace

std::span<const uint8_t> Encode(const leader_t& message, MessageBuffer* buffer) {
  return EncodeAny(message, buffer);
}
std::span<const uint8_t> Encode(const estimate_t& message, MessageBuffer* buffer) {
  return EncodeAny(message, buffer);
}
std::span<const uint8_t> Encode(const telemetry_t& message, MessageBuffer* buffer) {
  return EncodeAny(message, buffer);
}

std::span<const uint8_t> Encode(const command_t& message, MessageBuffer* buffer) {
  return EncodeAny(message, buffer);
}
std::span<const uint8_t> Encode(const reply_t& message, MessageBuffer* buffer) {
  return EncodeAny(message, buffer);
}

bool Decode(std::span<const uint8_t> payload, leader_t* message) {
  return DecodeAny(payload, message) && HasValidHeader(*message) && HasTaskDim(*message) &&
         HasFiniteState(*message) && AreFinite(message->path_time_s);
}

bool Decode(std::span<const uint8_t> payload, estimate_t* message) {
  return DecodeAny(payload, message) && HasValidHeader(*message) && HasTaskDim(*message) &&
         HasFiniteState(*message) && AreFinite(message->leader_age_s) && IsIn(message->arm_id, 1, kMaxArms) &&
         message->agreement >= 0 && IsState(message->state) && IsIn(message->stopped, 0, 1);
}

bool Decode(std::span<const uint8_t> payload, telemetry_t* message) {
  return DecodeAny(payload, message) && HasValidHeader(*message) && HasTaskDim(*message) &&
         IsIn(message->arm_id, 1, kMaxArms) && IsState(message->state) && IsIn(message->cause, 0, kCauses) &&
         IsIn(message->dof, 1, kMaxDof) && IsIn(message->parameter_count, 0, kMaxParameters) &&
         IsIn(message->synced, 0, 1) && AreFinite(message->q_rad) && AreFinite(message->dq_rad_s) &&
         AreFinite(message->tau_Nm) && AreFinite(message->x_m) && AreFinite(message->d_hat_Nm) &&
         AreFinite(message->theta_hat) &&
         AreFinite(message->error_m, message->subtask_error_rad_s, message->sigma_min);
}

bool Decode(std::span<const uint8_t> payload, command_t* message) {
  return DecodeAny(payload, message) && HasValidHeader(*message) && IsIn(message->arm_id, 0, kMaxArms) &&
         IsIn(message->request, 1, kRequests - 1) && message->heard_stamp_ns >= 0 &&
         message->heard_stamp_ns <= kMaxStampNs;
}

bool Decode(std::span<const uint8_t> payload, reply_t* message) {
  return DecodeAny(payload, message) && HasValidHeader(*message) && IsIn(message->arm_id, 1, kMaxArms) &&
         IsIn(message->request, 1, kRequests - 1) && IsState(message->state) &&
         IsIn(message->cause, 0, kCauses);
}

}  // namespace armada
