#pragma once

#include <algorithm>
#include <numeric>

#include "firmware/link/messages.h"

namespace armada {

// The messages whose bytes are in golden_bytes.h; golden_bytes.py makes the same ones.

inline void Set(double (&to)[3], double x, double y, double z) {
  to[0] = x;
  to[1] = y;
  to[2] = z;
}

inline leader_t GoldenLeader() {
  leader_t message{};
  message.stamp_ns = 0x0102030405060708;
  message.sequence = 1;
  message.path_time_s = 0.25;
  message.task_dim = 2;
  Set(message.x_m, 1.5, -2.0, 0.0);
  Set(message.v_m_s, 0.5, 4.0, 0.0);
  Set(message.a_m_s2, -8.0, 0.125, 0.0);
  Set(message.jerk_m_s3, 16.0, -0.5, 0.0);
  return message;
}

inline estimate_t GoldenEstimate() {
  estimate_t message{};
  message.stamp_ns = 1'000'000'007;
  message.sequence = 258;
  message.arm_id = 7;
  message.task_dim = 3;
  message.state = 6;
  message.stopped = 1;
  message.fleet_digest = 0x1122334455667788;
  message.agreement = 0x0102;
  message.leader_age_s = -1.0F;
  Set(message.x_m, 1.0, 2.0, 3.0);
  Set(message.v_m_s, -1.0, -2.0, -3.0);
  Set(message.a_m_s2, 0.5, 0.25, 0.125);
  Set(message.jerk_m_s3, -4.0, 8.0, -0.25);
  return message;
}

inline telemetry_t GoldenTelemetry() {
  telemetry_t message{};
  message.stamp_ns = 2'000'000'000;
  message.sequence = 3;
  message.arm_id = 6;
  message.dof = 7;
  message.task_dim = 2;
  message.parameter_count = 35;
  message.state = 4;
  message.cause = 3;
  message.synced = 1;
  std::iota(std::begin(message.q_rad), std::end(message.q_rad), 1.0);
  std::iota(std::begin(message.dq_rad_s), std::end(message.dq_rad_s), 11.0);
  std::iota(std::begin(message.tau_Nm), std::end(message.tau_Nm), 21.0);
  std::iota(std::begin(message.d_hat_Nm), std::end(message.d_hat_Nm), 31.0);
  std::iota(std::begin(message.theta_hat), std::end(message.theta_hat), 100.0);
  Set(message.x_m, 0.5, 1.5, 0.0);
  message.error_m = 0.25;
  message.subtask_error_rad_s = 0.75;
  message.sigma_min = 0.125;
  message.saturated_ticks = 1;
  message.missed_ticks = 2;
  message.wakeup_lateness_us = -3;
  message.compute_us = 4;
  message.sample_to_torque_us = 5;
  message.heap_allocations = 6;
  message.page_faults = 7;
  message.can_sent = 8;
  message.can_received = 9;
  message.can_dropped = 10;
  message.lcm_received = 11;
  message.lcm_rejected = 12;
  return message;
}

inline command_t GoldenCommand() {
  command_t message{};
  message.stamp_ns = 3'000'000'000;
  message.sequence = 5;
  message.arm_id = 7;
  message.request = 2;
  message.heard_stamp_ns = 1'000'000'007;
  message.fleet_digest = -2;
  return message;
}

inline reply_t GoldenReply() {
  reply_t message{};
  message.stamp_ns = 1'010'000'007;
  message.sequence = 9;
  message.arm_id = 7;
  message.request = 2;
  message.command_stamp_ns = 3'000'000'000;
  message.command_sequence = 5;
  message.refusals = 0x81;
  message.state = 5;
  message.cause = 6;
  return message;
}

}  // namespace armada
