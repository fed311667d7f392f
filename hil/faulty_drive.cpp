#include "hil/faulty_drive.h"

#include <algorithm>
#include <limits>

#include "hil/random.h"

namespace armada {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

FaultConfig InDrivesTime(FaultConfig fault, double start_s) {
  fault.at_s -= start_s;
  if (fault.until_s < FaultConfig::kForGood_s) fault.until_s -= start_s;
  return fault;
}

}  // namespace

double FaultyDrive::Fault::due_s() const {
  if (done) return kNever;
  if (!holds) return config.at_s;
  return signal ? std::min(config.until_s, signal->due_s()) : config.until_s;
}

FaultyDrive::FaultyDrive(std::unique_ptr<EmulatedDrive> drive, const JointDriveConfig& joint,
                         const std::vector<FaultConfig>& faults, double start_s, uint64_t seed)
    : drive_(std::move(drive)) {
  for (size_t i = 0; i < faults.size(); ++i) {
    const FaultConfig fault = InDrivesTime(faults[i], start_s);
    const uint64_t its_seed = RandomBits(seed, kFaultStream, i);
    Fault& added = faults_.emplace_back();
    added.config = fault;
    if (fault.signal == FaultSignal::kStatus) {
      added.status.emplace(joint, fault, its_seed);
    } else if (fault.kind == FaultKind::kDrive) {
      added.signal.emplace(fault, its_seed);
    }
  }
}

void FaultyDrive::Update(double t_s, const JointTruth& truth) {
  sensed_ = truth;
  for (Fault& fault : faults_) {
    if (!fault.done && t_s >= fault.config.until_s) fault.done = true;
    fault.holds = !fault.done && t_s >= fault.config.at_s;
    const bool position = fault.config.signal == FaultSignal::kPosition;
    if (!fault.holds || (!position && fault.config.signal != FaultSignal::kVelocity)) continue;
    double& value = position ? sensed_.position_rad : sensed_.velocity_rad_s;
    fault.signal->Update(t_s, value);
    value = fault.signal->Of(value);
  }
}

void FaultyDrive::Finish(double t_s, FrameList* out) {
  double tau_Nm = drive_->Torque(t_s);
  for (Fault& fault : faults_) {
    if (!fault.holds) continue;
    if (fault.config.kind == FaultKind::kDriveError) {
      drive_->Fail(t_s, &sent_);
      fault.done = true;
      tau_Nm = drive_->Torque(t_s);
    } else if (fault.config.signal == FaultSignal::kCurrent) {
      fault.signal->Update(t_s, tau_Nm);
      tau_Nm = fault.signal->Of(tau_Nm);
    }
  }
  for (CanFrame frame : sent_) {
    bool reaches = true;
    for (Fault& fault : faults_) {
      if (fault.status && !fault.status->Pass(t_s, fault.holds, &frame)) reaches = false;
    }
    if (reaches) out->Push(frame);
  }
  sent_.Clear();
}

void FaultyDrive::OnFrame(double t_s, const CanFrame& frame, const JointTruth& truth, FrameList* out) {
  Update(t_s, truth);
  drive_->OnFrame(t_s, frame, sensed_, &sent_);
  Finish(t_s, out);
}

void FaultyDrive::OnTime(double t_s, const JointTruth& truth, FrameList* out) {
  Update(t_s, truth);
  drive_->OnTime(t_s, sensed_, &sent_);
  Finish(t_s, out);
}

// Without power there is no current to be wrong.
double FaultyDrive::Torque(double t_s) const {
  double tau_Nm = drive_->Torque(t_s);
  if (!drive_->ProducesTorque()) return tau_Nm;
  for (const Fault& fault : faults_) {
    if (fault.holds && fault.config.signal == FaultSignal::kCurrent) tau_Nm = fault.signal->Of(tau_Nm);
  }
  return tau_Nm;
}

double FaultyDrive::NextTorqueChange(double t_s) const {
  double next_s = drive_->NextTorqueChange(t_s);
  for (const Fault& fault : faults_) {
    if (const double due_s = fault.due_s(); due_s > t_s) next_s = std::min(next_s, due_s);
  }
  return next_s;
}

double FaultyDrive::NextEvent(double t_s) const {
  double next_s = drive_->NextEvent(t_s);
  for (const Fault& fault : faults_) next_s = std::min(next_s, std::max(t_s, fault.due_s()));
  return next_s;
}

std::unique_ptr<EmulatedDrive> WithFaults(std::unique_ptr<EmulatedDrive> drive, const JointDriveConfig& joint,
                                          const std::vector<FaultConfig>& faults, int arm_id,
                                          int joint_number, double start_s, uint64_t seed) {
  std::vector<FaultConfig> its;
  for (const FaultConfig& fault : faults) {
    const bool of_drive = fault.kind == FaultKind::kDrive || fault.kind == FaultKind::kDriveError;
    if (of_drive && fault.arm == arm_id && (fault.joint == 0 || fault.joint == joint_number)) {
      its.push_back(fault);
    }
  }
  if (its.empty()) return drive;
  return std::make_unique<FaultyDrive>(std::move(drive), joint, its, start_s, seed);
}

}  // namespace armada
