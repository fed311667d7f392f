#include "firmware/app/joint_set.h"

#include <algorithm>
#include <cmath>

#include "firmware/can/feedback_step.h"
#include "firmware/can/make_drive.h"

namespace armada {
namespace {

double Seconds(int64_t duration_ns) {
  return 1e-9 * static_cast<double>(duration_ns);
}

bool IsInTorqueMode(const JointDrive& drive) {
  return drive.state() == DriveState::kTorque;
}

}  // namespace

JointSet::JointSet(const FleetConfig& fleet, size_t arm)
    : timing_(fleet.timing),
      supervisor_(fleet.arms[arm].control.supervisor),
      drives_(MakeDrives(fleet.arms[arm].joints)),
      believed_(drives_.size()),
      was_in_torque_(drives_.size(), false),
      prepared_(drives_.size(), false),
      asked_(drives_.size(), false) {
  const SensorConfig sensor = fleet.ControllerConfig(arm).control.sensor;
  for (size_t i = 0; i < drives_.size(); ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    const JointDriveConfig& drive = fleet.arms[arm].joints[i];
    frozen_.emplace_back(FrozenFeedback::Limits{
        .speed_noise_rad_s = sensor.frozen_deviations * sensor.velocity_deviation_rad_s[joint],
        .travel_max_rad = sensor.frozen_travel_rad + FeedbackStepOf(drive).position_rad,
        .torque_limit_Nm = drive.torque_limit_Nm,
        .pushed_max_s = sensor.frozen_pushed_s});
    consistency_.emplace_back(FeedbackConsistency::Limits{
        .travel_max_rad = sensor.consistent_travel_rad + FeedbackStepOf(drive).position_rad,
        .speed_noise_rad_s = sensor.consistent_deviations * sensor.velocity_deviation_rad_s[joint],
        .memory_s = sensor.consistent_s});
  }
}

bool JointSet::Prepare(int64_t now_ns, FrameList* out) {
  for (size_t i = 0; i < drives_.size(); ++i) prepared_[i] = drives_[i]->Prepare(now_ns, out);
  return std::all_of(prepared_.begin(), prepared_.end(), [](bool prepared) { return prepared; });
}

void JointSet::BringUpRest(int64_t now_ns, FrameList* out) {
  for (const auto& drive : drives_) {
    if (!IsInTorqueMode(*drive)) drive->BringUp(now_ns, out);
  }
}

void JointSet::BringUp(int64_t now_ns, FrameList* out) {
  for (const auto& drive : drives_) drive->BringUp(now_ns, out);
}

bool JointSet::AllInTorqueMode() const {
  return std::all_of(drives_.begin(), drives_.end(),
                     [](const auto& drive) { return IsInTorqueMode(*drive); });
}

bool JointSet::AnyLeft() const {
  for (size_t i = 0; i < drives_.size(); ++i) {
    if (drives_[i]->state() == DriveState::kFault || (was_in_torque_[i] && !IsInTorqueMode(*drives_[i])))
      return true;
  }
  return false;
}

std::string JointSet::Explain() const {
  std::string text;
  for (size_t i = 0; i < drives_.size(); ++i) {
    if (IsInTorqueMode(*drives_[i])) continue;
    if (!text.empty()) text += "; ";
    text += "joint " + std::to_string(i + 1) + ": " + drives_[i]->Explain();
  }
  return text;
}

void JointSet::Reset() {
  for (const auto& drive : drives_) drive->Reset();
  std::fill(was_in_torque_.begin(), was_in_torque_.end(), false);
  std::fill(prepared_.begin(), prepared_.end(), false);
  good_ticks_ = 0;
}

void JointSet::ExpectNewSamples(int64_t now_ns) {
  request_ns_ = now_ns;
  if (first_request_ns_ == 0) first_request_ns_ = now_ns;
  for (size_t i = 0; i < drives_.size(); ++i) sequence_at_request_[i] = drives_[i]->sample().sequence;
}

void JointSet::RequestSamples(int64_t now_ns, ControllerState state, FrameList* out) {
  for (size_t i = 0; i < drives_.size(); ++i) {
    const bool others = state <= ControllerState::kMonitor ? prepared_[i] : state != ControllerState::kArming;
    asked_[i] = others || IsInTorqueMode(*drives_[i]);
    if (asked_[i]) drives_[i]->RequestSample(now_ns, out);
  }
}

Reception JointSet::OnFrame(const CanFrame& frame) {
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

bool JointSet::SamplesComplete() const {
  for (size_t i = 0; i < drives_.size(); ++i) {
    if (drives_[i]->sample().sequence == sequence_at_request_[i]) return false;
  }
  return true;
}

// A joint cannot have moved faster than it can.
bool JointSet::IsBelievable(size_t joint, const JointSample& sample) {
  const JointSample& last = believed_[joint];
  if (last.sequence == 0) return true;
  const double since_s = std::max(timing_.period_s, Seconds(sample.stamp_ns - last.stamp_ns));
  return std::abs(sample.position_rad - last.position_rad) <= supervisor_.speed_max_rad_s * since_s;
}

void JointSet::ReadAt(int64_t tick_ns, int64_t epoch_ns, const JointVector& sent_Nm, ArmInput* input) {
  // A drive samples between the request and the answer's arrival.
  int64_t sum_ns = 0;
  int fresh = 0;
  for (size_t i = 0; i < drives_.size(); ++i) {
    const JointSample& sample = drives_[i]->sample();
    if (sample.sequence == sequence_at_request_[i]) continue;
    sum_ns += (request_ns_ + sample.stamp_ns) / 2 - tick_ns;
    ++fresh;
  }
  const int64_t sample_ns = tick_ns + (fresh > 0 ? sum_ns / fresh : 0);
  input->sample_s = Seconds(sample_ns - epoch_ns);
  input->samples_valid = true;
  bool all_good = true;
  for (size_t i = 0; i < drives_.size(); ++i) {
    const JointSample& newest = drives_[i]->sample();
    const auto joint = static_cast<Eigen::Index>(i);
    const bool is_new = newest.sequence != sequence_at_request_[i];
    const bool believable = IsBelievable(i, newest);
    const bool is_fresh = is_new && believable;
    if (is_new && !believable) nonsense_since_complete_ = true;
    if (newest.sequence != believed_[i].sequence && believable) {
      const double since_s = Seconds(newest.stamp_ns - believed_[i].stamp_ns);
      if (consistency_[i].Update(newest.position_rad, newest.velocity_rad_s, since_s))
        input->causes.Add(Cause::kFeedbackNonsense);
      believed_[i] = newest;
    }
    const JointSample& sample = believed_[i];
    // A drive may take as long for its first answer as for any other.
    const bool answered = sample.sequence != 0;
    const int64_t since_ns = answered ? sample.stamp_ns : first_request_ns_;
    const double age_s = is_fresh ? 0.0 : Seconds(sample_ns - since_ns);
    const bool in_torque = IsInTorqueMode(*drives_[i]);
    was_in_torque_[i] = was_in_torque_[i] || in_torque;
    all_good = all_good && is_fresh;
    const bool braked = !asked_[i];
    const bool stale = age_s > timing_.feedback_stale_s && !(braked && answered);
    if (stale) input->causes.Add(nonsense_since_complete_ ? Cause::kFeedbackNonsense : Cause::kFeedbackStale);
    if (stale || !answered) {
      input->samples_valid = false;
      continue;
    }
    input->causes.Set(Cause::kSampleLate, age_s > supervisor_.feedback_late_s && !braked);
    if (is_fresh &&
        frozen_[i].Update(sample.position_rad, sample.velocity_rad_s, sent_Nm[joint], timing_.period_s)) {
      input->causes.Add(Cause::kFeedbackFrozen);
    }
    input->q_rad[joint] = sample.position_rad + (braked ? 0.0 : age_s * sample.velocity_rad_s);
    input->dq_rad_s[joint] = sample.velocity_rad_s;
  }
  if (all_good) nonsense_since_complete_ = false;
  good_ticks_ = all_good ? std::min(good_ticks_ + 1, supervisor_.good_samples) : 0;
  input->samples_good = good_ticks_ >= supervisor_.good_samples;
}

void JointSet::CommandTorques(const JointVector& tau_Nm, FrameList* out) {
  for (size_t i = 0; i < drives_.size(); ++i) {
    if (IsInTorqueMode(*drives_[i])) drives_[i]->CommandTorque(tau_Nm[static_cast<Eigen::Index>(i)], out);
  }
}

void JointSet::QuickStop(FrameList* out) {
  for (const auto& drive : drives_) drive->QuickStop(out);
}

void JointSet::Disable(FrameList* out) {
  for (const auto& drive : drives_) drive->Disable(out);
}

}  // namespace armada
