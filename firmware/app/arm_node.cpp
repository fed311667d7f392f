#include "firmware/app/arm_node.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "firmware/can/feedback_step.h"
#include "firmware/can/make_drive.h"

namespace armada {
namespace {

constexpr int kLeader = kLeaderSender;
constexpr float kNoLeader = -1.0f;  // in a message: no leader state is behind this estimate

double Seconds(int64_t duration_ns) {
  return 1e-9 * static_cast<double>(duration_ns);
}

void Copy(const TaskVector& from, double (&to)[3]) {
  std::copy(from.data(), from.data() + from.size(), to);
}

TaskVector ToTask(const double (&from)[3]) {
  TaskVector to(PlanarArm::kTaskDim);
  std::copy(from, from + PlanarArm::kTaskDim, to.data());
  return to;
}

}  // namespace

ArmNode::ArmNode(const FleetConfig& fleet, size_t index, const ArmInitialState& initial, int64_t epoch_ns,
                 const std::optional<LinkIdentity>& identity)
    : id_(fleet.arms[index].id),
      estimate_channel_(EstimateChannel(id_)),
      telemetry_channel_(TelemetryChannel(id_)),
      link_(fleet.link),
      estimator_(fleet.estimator),
      timing_(fleet.timing),
      schedule_(fleet.Schedule()),
      epoch_ns_(epoch_ns),
      drives_(MakeDrives(fleet.arms[index].joints)),
      controller_(fleet.ControllerConfig(index), initial) {
  for (size_t topology = 0; topology < fleet.topologies.size(); ++topology) {
    for (const Pin& pin : fleet.topologies[topology].pins) {
      if (pin.arm == id_) ListenTo(fleet, kLeader, topology, pin.weight, identity);
    }
    for (const Edge& edge : fleet.topologies[topology].edges) {
      if (edge.to == id_) ListenTo(fleet, edge.from, topology, edge.weight, identity);
    }
  }
  const auto dof = static_cast<Eigen::Index>(drives_.size());
  input_.q_rad = JointVector::Zero(dof);
  input_.dq_rad_s = JointVector::Zero(dof);
  input_.neighbours.count = static_cast<int>(sources_.size());
  if (identity) sealer_.emplace(*identity, id_);
  const SensorConfig sensor = fleet.ControllerConfig(index).control.sensor;
  for (size_t i = 0; i < drives_.size(); ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    const JointDriveConfig& drive = fleet.arms[index].joints[i];
    frozen_.emplace_back(FrozenFeedback::Limits{
        .speed_noise_rad_s = sensor.frozen_deviations * sensor.velocity_deviation_rad_s[joint],
        .travel_max_rad = sensor.frozen_travel_rad + FeedbackStepOf(drive).position_rad,
        .torque_limit_Nm = drive.torque_limit_Nm,
        .pushed_max_s = sensor.frozen_pushed_s});
  }
}

void ArmNode::ListenTo(const FleetConfig& fleet, int arm_id, size_t topology, double weight,
                       const std::optional<LinkIdentity>& identity) {
  auto source =
      std::find_if(sources_.begin(), sources_.end(), [&](const Source& s) { return s.arm_id == arm_id; });
  if (source == sources_.end()) {
    sources_.push_back({.arm_id = arm_id, .seal = std::nullopt, .clock = ClockOffset(fleet.link.clock)});
    source = sources_.end() - 1;
    if (identity) source->seal.emplace(identity->key, arm_id);
  }
  source->weight[topology] = weight;
}

bool ArmNode::BringUp(int64_t now_ns, FrameList* out) {
  for (const auto& drive : drives_) drive->BringUp(now_ns, out);
  return std::all_of(drives_.begin(), drives_.end(),
                     [](const auto& drive) { return drive->state() == DriveState::kTorque; });
}

std::string ArmNode::ExplainDrives() const {
  std::string text;
  for (size_t i = 0; i < drives_.size(); ++i) {
    if (drives_[i]->state() == DriveState::kTorque) continue;
    if (!text.empty()) text += "; ";
    text += "joint " + std::to_string(i + 1) + ": " + drives_[i]->Explain();
  }
  return text;
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
  message.agreement = static_cast<int16_t>(controller_.estimator().agreement());
  const double leader_age_s = controller_.estimator().leader_age_s();
  message.leader_age_s = std::isfinite(leader_age_s) ? static_cast<float>(leader_age_s) : kNoLeader;
  Copy(zeta.x_m, message.x_m);
  Copy(zeta.v_m_s, message.v_m_s);
  Copy(zeta.a_m_s2, message.a_m_s2);
  Copy(controller_.estimator().jerk_m_s3(), message.jerk_m_s3);
  return SealIfKeyed(sealer_, estimate_channel_, Encode(message, buffer), buffer);
}

std::span<const uint8_t> ArmNode::EncodeTelemetry(const telemetry_t& telemetry, MessageBuffer* buffer) {
  return SealIfKeyed(sealer_, telemetry_channel_, Encode(telemetry, buffer), buffer);
}

void ArmNode::RequestSamples(int64_t now_ns, FrameList* out) {
  request_ns_ = now_ns;
  for (size_t i = 0; i < drives_.size(); ++i) {
    sequence_at_request_[i] = drives_[i]->sample().sequence;
    drives_[i]->RequestSample(now_ns, out);
  }
}

Reception ArmNode::OnFrame(const CanFrame& frame) {
  for (const auto& drive : drives_) {
    const Reception reception = drive->OnFrame(frame);
    if (reception == Reception::kNotMine) continue;
    if (reception == Reception::kMalformed) {
      ++malformed_frames_;
      nonsense_since_complete_ = true;
    }
    return reception;
  }
  return Reception::kNotMine;
}

bool ArmNode::SamplesComplete() const {
  for (size_t i = 0; i < drives_.size(); ++i) {
    if (drives_[i]->sample().sequence == sequence_at_request_[i]) return false;
  }
  return true;
}

bool ArmNode::Hears(const Source& source, std::string_view channel) {
  return source.arm_id == kLeader ? channel == kLeaderChannel
                                  : ParseArmChannel(kEstimatePrefix, channel) == source.arm_id;
}

void ArmNode::OnMessage(const LcmMessage& message) {
  const auto source = std::find_if(sources_.begin(), sources_.end(),
                                   [&](const Source& s) { return Hears(s, message.channel); });
  if (source == sources_.end()) return;
  LcmMessage unsealed = message;
  if (!Unseal(*source, message.channel, &unsealed.payload)) return;
  const bool understood =
      source->arm_id == kLeader ? TakeLeader(*source, unsealed) : TakeEstimate(*source, unsealed);
  if (!understood) ++rejected_messages_.malformed;
}

bool ArmNode::Unseal(Source& source, std::string_view channel, std::span<const uint8_t>* message) {
  if (!source.seal) return true;
  const SealVerdict verdict = source.seal->Open(channel, message);
  if (verdict == SealVerdict::kForged) ++rejected_messages_.forged;
  if (verdict == SealVerdict::kReplayed) ++rejected_messages_.replayed;
  return verdict == SealVerdict::kGenuine;
}

// False when it is no message of ours; of those that are, the newest counts.
bool ArmNode::TakeLeader(Source& source, const LcmMessage& message) {
  leader_t leader;
  if (!Decode(message.payload, &leader) || leader.task_dim != PlanarArm::kTaskDim) return false;
  if (Take(source, leader, message.arrival_ns)) source.neighbour.agreement = Estimator::kMaxAgreement;
  return true;
}

bool ArmNode::TakeEstimate(Source& source, const LcmMessage& message) {
  estimate_t estimate;
  if (!Decode(message.payload, &estimate) || estimate.task_dim != PlanarArm::kTaskDim ||
      estimate.arm_id != source.arm_id) {
    return false;
  }
  if (Take(source, estimate, message.arrival_ns)) {
    source.neighbour.agreement = estimate.agreement;
    source.leader_age_s = estimate.leader_age_s >= 0.0f ? double{estimate.leader_age_s}
                                                        : std::numeric_limits<double>::infinity();
  }
  return true;
}

template <class Message>
bool ArmNode::Take(Source& source, const Message& message, int64_t arrival_ns) {
  if (source.clock.Update({message.sequence, message.stamp_ns, arrival_ns}) == Freshness::kStale) {
    ++rejected_messages_.stale;
    return false;
  }
  if (AgeOf(source, message.stamp_ns, arrival_ns) > link_.age_max_s) {
    ++rejected_messages_.late;
    return false;
  }
  const Zeta zeta{ToTask(message.x_m), ToTask(message.v_m_s), ToTask(message.a_m_s2)};
  if (!IsPlausible(source, zeta, message.stamp_ns)) {
    ++rejected_messages_.implausible;
    return false;
  }
  source.stamp_ns = message.stamp_ns;
  source.neighbour.zeta = zeta;
  source.neighbour.jerk_m_s3 = ToTask(message.jerk_m_s3);
  source.neighbour.heard = true;
  return true;
}

// Whether a state can follow the sender's last one. A leader within (A2), and (1.9) while it is in contact,
// leave a prediction by no more than beta over the time; after a time without news (1.9) makes up for that
// time, too. Once the last state is too old to judge by, or of a former life, any is taken.
bool ArmNode::IsPlausible(const Source& source, const Zeta& zeta, int64_t stamp_ns) const {
  if (estimator_.kind != EstimatorKind::kPredictive || !source.neighbour.heard) return true;
  const double since_s = Seconds(stamp_ns - source.stamp_ns);
  if (since_s <= 0.0 || since_s > link_.age_max_s) return true;
  const Zeta expected = Taylor(source.neighbour.zeta, since_s);
  const double allowed_s =
      link_.plausible_step * (since_s + std::min(source.leader_age_s, estimator_.age_max_s));
  const auto near = [&](const TaskVector& given, const TaskVector& predicted, double beta) {
    return (given - predicted).lpNorm<Eigen::Infinity>() <= beta * allowed_s;
  };
  return near(zeta.x_m, expected.x_m, estimator_.beta_1_m_s) &&
         near(zeta.v_m_s, expected.v_m_s, estimator_.beta_2_m_s2) &&
         near(zeta.a_m_s2, expected.a_m_s2, estimator_.beta_3_m_s3);
}

double ArmNode::AgeOf(const Source& source, int64_t stamp_ns, int64_t now_ns) const {
  return link_.shared_clock ? Seconds(now_ns - stamp_ns) : source.clock.AgeS(stamp_ns, now_ns);
}

void ArmNode::ReadNeighbours(int64_t tick_ns) {
  const size_t topology = schedule_.At(Seconds(tick_ns - epoch_ns_));
  for (size_t i = 0; i < sources_.size(); ++i) {
    Source& source = sources_[i];
    source.neighbour.weight = source.weight[topology];
    if (source.neighbour.heard) {
      source.neighbour.age_s = AgeOf(source, source.stamp_ns, tick_ns);
      source.neighbour.leader_age_s = source.leader_age_s + source.neighbour.age_s;
    }
    input_.neighbours.list[i] = source.neighbour;
  }
}

// Joint state at one instant from samples of slightly different ones, missing ones predicted; or why no
// torque may rest on them.
FaultCause ArmNode::ReadJoints(int64_t tick_ns) {
  // A drive samples between the request and the answer's arrival.
  int64_t sum_ns = 0;
  int fresh = 0;
  for (size_t i = 0; i < drives_.size(); ++i) {
    const JointSample& sample = drives_[i]->sample();
    if (sample.sequence == sequence_at_request_[i]) continue;
    sum_ns += (request_ns_ + sample.stamp_ns) / 2 - tick_ns;
    ++fresh;
  }
  if (SamplesComplete()) nonsense_since_complete_ = false;
  const int64_t sample_ns = tick_ns + (fresh > 0 ? sum_ns / fresh : 0);
  input_.tick_s = Seconds(tick_ns - epoch_ns_);
  input_.sample_s = Seconds(sample_ns - epoch_ns_);
  for (size_t i = 0; i < drives_.size(); ++i) {
    const JointSample& sample = drives_[i]->sample();
    const auto joint = static_cast<Eigen::Index>(i);
    const bool is_fresh = sample.sequence != sequence_at_request_[i];
    const double age_s = is_fresh ? 0.0 : Seconds(sample_ns - sample.stamp_ns);
    if (sample.sequence == 0 || age_s > timing_.feedback_stale_s)
      return nonsense_since_complete_ ? FaultCause::kFeedbackNonsense : FaultCause::kFeedbackStale;
    const JointVector& tau_Nm = controller_.status().tau_Nm;  // empty before the first
    const double sent_Nm = tau_Nm.size() > 0 ? tau_Nm[joint] : 0.0;
    if (is_fresh &&
        frozen_[i].Update(sample.position_rad, sample.velocity_rad_s, sent_Nm, timing_.period_s)) {
      return FaultCause::kFeedbackFrozen;
    }
    input_.q_rad[joint] = sample.position_rad + age_s * sample.velocity_rad_s;
    input_.dq_rad_s[joint] = sample.velocity_rad_s;
  }
  return FaultCause::kNone;
}

void ArmNode::Step(int64_t tick_ns, FrameList* out) {
  input_.tick_s = input_.sample_s = Seconds(tick_ns - epoch_ns_);
  ReadNeighbours(tick_ns);
  const bool drives_follow = std::all_of(drives_.begin(), drives_.end(), [](const auto& drive) {
    return drive->state() == DriveState::kTorque;
  });
  if (state_ != ControllerState::kFault) {
    if (!drives_follow) {
      Fail(FaultCause::kDriveLeftTorque, out);
    } else if (const FaultCause cause = ReadJoints(tick_ns); cause != FaultCause::kNone) {
      Fail(cause, out);
    }
  }
  if (state_ == ControllerState::kFault) {
    controller_.StepEstimator(input_.tick_s, input_.neighbours);
    return;
  }

  const JointVector tau_Nm = controller_.Step(input_);
  state_ = controller_.status().state;
  if (state_ == ControllerState::kFault) return Fail(FaultCause::kNonFiniteTorque, out);
  for (size_t i = 0; i < drives_.size(); ++i) {
    drives_[i]->CommandTorque(tau_Nm[static_cast<Eigen::Index>(i)], out);
  }
}

void ArmNode::Fail(FaultCause cause, FrameList* out) {
  if (fault_ == FaultCause::kNone) fault_ = cause;  // the first is the reason, later ones follow from it
  state_ = ControllerState::kFault;
  Disable(out);
}

void ArmNode::Disable(FrameList* out) {
  for (const auto& drive : drives_) drive->Disable(out);
}

void ArmNode::FillTelemetry(telemetry_t* telemetry) {
  const ArmStatus& status = controller_.status();
  const ParameterVector& theta_hat = controller_.theta_hat();
  const JointVector d_hat_Nm = controller_.d_hat_Nm();
  telemetry->stamp_ns = epoch_ns_ + std::llround(input_.sample_s * 1e9);
  telemetry->sequence = ++telemetry_sequence_;
  telemetry->arm_id = static_cast<int8_t>(id_);
  telemetry->dof = static_cast<int8_t>(drives_.size());
  telemetry->task_dim = PlanarArm::kTaskDim;
  telemetry->parameter_count = static_cast<int8_t>(theta_hat.size());
  telemetry->state = static_cast<int8_t>(state_);
  telemetry->synced = static_cast<int8_t>(controller_.estimator().synced());
  const auto copy = [](const auto& from, double* to) {
    std::copy(from.data(), from.data() + from.size(), to);
  };
  copy(input_.q_rad, telemetry->q_rad);
  copy(input_.dq_rad_s, telemetry->dq_rad_s);
  if (state_ == ControllerState::kFault) {
    std::fill(std::begin(telemetry->tau_Nm), std::end(telemetry->tau_Nm), 0.0);
  } else {
    copy(status.tau_Nm, telemetry->tau_Nm);
  }
  copy(status.x_m, telemetry->x_m);
  copy(d_hat_Nm, telemetry->d_hat_Nm);
  copy(theta_hat, telemetry->theta_hat);
  telemetry->error_m = status.error_m;
  telemetry->subtask_error_rad_s = status.subtask_error_rad_s;
  telemetry->sigma_min = status.sigma_min;
  telemetry->saturated_ticks = controller_.saturated_ticks();
  telemetry->lcm_rejected = rejected_messages_.total();
}

}  // namespace armada
