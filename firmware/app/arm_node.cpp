#include "firmware/app/arm_node.h"

#include <algorithm>
#include <cmath>

namespace armada {
namespace {

constexpr float kNoLeader = -1.0f;  // in a message: no leader state is behind this estimate

double Seconds(int64_t duration_ns) {
  return 1e-9 * static_cast<double>(duration_ns);
}

void Copy(const TaskVector& from, double (&to)[3]) {
  std::copy(from.data(), from.data() + from.size(), to);
}

}  // namespace

ArmNode::ArmNode(const FleetConfig& fleet, size_t index, const ArmInitialState& initial, int64_t epoch_ns,
                 const BoardStart& start)
    : id_(fleet.arms[index].id),
      estimate_channel_(EstimateChannel(id_)),
      telemetry_channel_(TelemetryChannel(id_)),
      reply_channel_(ReplyChannel(id_)),
      epoch_ns_(epoch_ns),
      fleet_digest_(start.fleet_digest),
      hold_with_neighbours_(fleet.arms[index].control.supervisor.fleet_stop == FleetStop::kHold),
      good_ticks_needed_(fleet.arms[index].control.supervisor.good_samples),
      quick_stop_s_(fleet.arms[index].control.supervisor.quick_stop_s),
      joints_(fleet, index),
      neighbourhood_(fleet, id_, epoch_ns, start.identity, start.fleet_digest),
      desk_(id_, start.identity, start.fleet_digest, fleet.link.command_age_max_s),
      bus_watch_(fleet.timing, fleet.arms[index].control.supervisor),
      controller_(fleet.ControllerConfig(index), initial, start.mode),
      estimate_age_max_ns_(std::llround(fleet.link.age_max_s * 1e9)),
      estimate_counts_(start.mode == StartMode::kRunning) {
  const auto dof = static_cast<Eigen::Index>(joints_.size());
  input_.q_rad = JointVector::Zero(dof);
  input_.dq_rad_s = JointVector::Zero(dof);
  input_.drives_ready = false;
  if (start.identity) sealer_.emplace(*start.identity, id_);
}

bool ArmNode::BringUp(int64_t now_ns, FrameList* out) {
  joints_.BringUp(now_ns, out);
  return joints_.AllInTorqueMode();
}

std::span<const uint8_t> ArmNode::EncodeEstimate(int64_t tick_ns, MessageBuffer* buffer) {
  // The estimate was computed for the end of the previous tick; later, ticks were missed.
  const Zeta& zeta = controller_.zeta();
  const bool started = controller_.zeta_time_s() > 0.0;
  estimate_t message{};
  message.stamp_ns = started ? epoch_ns_ + std::llround(controller_.zeta_time_s() * 1e9) : tick_ns;
  message.sequence = ++estimate_sequence_;
  message.arm_id = static_cast<int8_t>(id_);
  message.task_dim = PlanarArm::kTaskDim;
  message.state = static_cast<int8_t>(state());
  message.stopped = static_cast<int8_t>(controller_.supervisor().announces_stop());
  message.fleet_digest = fleet_digest_;
  message.agreement = static_cast<int16_t>(controller_.estimator().agreement());
  const double leader_age_s = controller_.estimator().leader_age_s();
  // A board that starts anew among others, that hears of the leader again after it has lost it, or that got
  // no time for a while, must not draw them to where it is.
  const bool slept = tick_ns - message.stamp_ns > estimate_age_max_ns_;
  estimate_counts_ =
      !slept && !controller_.leader_lost() && (estimate_counts_ || controller_.estimator().in_band());
  const bool knows = estimate_counts_ && std::isfinite(leader_age_s);
  message.leader_age_s = knows ? static_cast<float>(leader_age_s) : kNoLeader;
  Copy(zeta.x_m, message.x_m);
  Copy(zeta.v_m_s, message.v_m_s);
  Copy(zeta.a_m_s2, message.a_m_s2);
  Copy(controller_.estimator().jerk_m_s3(), message.jerk_m_s3);
  return SealIfKeyed(sealer_, estimate_channel_, Encode(message, buffer), buffer);
}

std::span<const uint8_t> ArmNode::EncodeTelemetry(const telemetry_t& telemetry, MessageBuffer* buffer) {
  return SealIfKeyed(sealer_, telemetry_channel_, Encode(telemetry, buffer), buffer);
}

std::span<const uint8_t> ArmNode::EncodeReply(int64_t tick_ns, MessageBuffer* buffer) {
  const auto reply = desk_.TakeReply(tick_ns);
  if (!reply) return {};
  return SealIfKeyed(sealer_, reply_channel_, Encode(*reply, buffer), buffer);
}

// Requests feed the watchdogs of some drives. One that gets no torques must not be kept from stopping.
void ArmNode::RequestSamples(int64_t now_ns, FrameList* out) {
  joints_.ExpectNewSamples(now_ns);
  if (!bus_watch_.loses_torques()) joints_.RequestSamples(now_ns, state(), out);
}

void ArmNode::OnMessage(const LcmMessage& message) {
  neighbourhood_.OnMessage(message);
  desk_.OnMessage(message);
}

void ArmNode::Step(int64_t tick_ns, FrameList* out) {
  input_.tick_s = input_.sample_s = Seconds(tick_ns - epoch_ns_);
  input_.causes = bus_watch_.Take(tick_ns);
  HearOthers(tick_ns);
  ReadJoints(tick_ns, out);
  input_.request = desk_.TakeRequest(tick_ns);
  const ControllerState before = state();
  const JointVector tau_Nm = controller_.Step(input_);
  desk_.Answer(controller_.supervisor().refusals(), state(), cause());
  if (GivesTorque(state())) joints_.CommandTorques(tau_Nm, out);
  Act(before, tick_ns, out);
}

void ArmNode::HearOthers(int64_t tick_ns) {
  neighbourhood_.ReadAt(tick_ns, &input_.neighbours);
  neighbours_good_ticks_ =
      neighbourhood_.AllGood(tick_ns) ? std::min(neighbours_good_ticks_ + 1, good_ticks_needed_) : 0;
  input_.neighbours_good = neighbours_good_ticks_ >= good_ticks_needed_;
  for (int j = 0; hold_with_neighbours_ && j < input_.neighbours.count; ++j) {
    const Neighbour& neighbour = input_.neighbours.list[static_cast<size_t>(j)];
    input_.causes.Set(Cause::kFleetStop, neighbour.stopped || neighbour.silent);  // the dead tell nothing
  }
}

void ArmNode::ReadJoints(int64_t tick_ns, FrameList* out) {
  const bool idle = state() == ControllerState::kInit || state() == ControllerState::kMonitor;
  input_.drives_enabled = joints_.AllInTorqueMode();
  if (idle && !input_.drives_enabled) input_.drives_ready = joints_.Prepare(tick_ns, out);
  joints_.ReadAt(tick_ns, epoch_ns_, controller_.status().tau_Nm, &input_);
  input_.causes.Set(Cause::kDriveLeftTorque, joints_.AnyLeft());
}

// What a state means for the drives, beside the torques.
void ArmNode::Act(ControllerState before, int64_t tick_ns, FrameList* out) {
  switch (state()) {
    case ControllerState::kInit:
      if (before == ControllerState::kHold || before == ControllerState::kFault) {
        joints_.Disable(out);
        joints_.Reset();
        bus_watch_.Reset();
      }
      return;
    case ControllerState::kArming:
      return joints_.BringUpRest(tick_ns, out);
    case ControllerState::kFault:
      return StopDrives(before, tick_ns, out);
    case ControllerState::kMonitor:
    case ControllerState::kRun:
    case ControllerState::kDegraded:
    case ControllerState::kHold:
    case ControllerState::kSafeStop:
      return;
  }
}

// In every tick: a single frame may be lost, and a drive that is spoken to does not trip its watchdog.
void ArmNode::StopDrives(ControllerState before, int64_t tick_ns, FrameList* out) {
  if (before != ControllerState::kFault) {
    fault_ns_ = tick_ns;
    was_at_rest_ = before == ControllerState::kSafeStop;
  }
  if (was_at_rest_ || Seconds(tick_ns - fault_ns_) > quick_stop_s_) return joints_.Disable(out);
  joints_.QuickStop(out);
}

void ArmNode::FillTelemetry(telemetry_t* telemetry) {
  const ArmStatus& status = controller_.status();
  const ParameterVector& theta_hat = controller_.theta_hat();
  const JointVector d_hat_Nm = controller_.d_hat_Nm();
  telemetry->stamp_ns = epoch_ns_ + std::llround(input_.sample_s * 1e9);
  telemetry->sequence = ++telemetry_sequence_;
  telemetry->arm_id = static_cast<int8_t>(id_);
  telemetry->dof = static_cast<int8_t>(joints_.size());
  telemetry->task_dim = PlanarArm::kTaskDim;
  telemetry->parameter_count = static_cast<int8_t>(theta_hat.size());
  telemetry->state = static_cast<int8_t>(state());
  telemetry->cause = static_cast<int8_t>(cause());
  telemetry->synced = static_cast<int8_t>(controller_.estimator().synced());
  const auto copy = [](const auto& from, double* to) {
    std::copy(from.data(), from.data() + from.size(), to);
  };
  copy(input_.q_rad, telemetry->q_rad);
  copy(input_.dq_rad_s, telemetry->dq_rad_s);
  copy(status.tau_Nm, telemetry->tau_Nm);
  copy(status.x_m, telemetry->x_m);
  copy(d_hat_Nm, telemetry->d_hat_Nm);
  copy(theta_hat, telemetry->theta_hat);
  telemetry->error_m = status.error_m;
  telemetry->subtask_error_rad_s = status.subtask_error_rad_s;
  telemetry->sigma_min = status.sigma_min;
  telemetry->saturated_ticks = controller_.saturated_ticks();
  telemetry->lcm_rejected = rejected_count();
}

}  // namespace armada
