#include "hil/emulated_arm.h"

#include <algorithm>
#include <cmath>

#include "hil/faulty_drive.h"
#include "hil/random.h"
#include "hil/same_instant.h"

namespace armada {

EmulatedArm::EmulatedArm(const ScenarioConfig& scenario, size_t index, uint64_t seed, const ArmStart& start,
                         const LeaderPath* leader, double start_s)
    : id_(scenario.fleet.arms[index].id),
      joints_(scenario.fleet.arms[index].joints),
      seed_(seed),
      config_(scenario.plant),
      plant_(scenario.fleet.arms[index].arm),
      disturbance_(scenario.disturbance, seed, scenario.fleet.arms[index].id),
      leader_(leader),
      start_speed_rad_s_(start.dq_rad_s),
      start_s_(start_s) {
  plant_.q_rad = start.q_rad;
  const ArmEntry& entry = scenario.fleet.arms[index];
  for (size_t i = 0; i < entry.joints.size(); ++i) {
    const uint64_t sensor_seed = RandomBits(seed, kSensorStream, static_cast<uint64_t>(entry.id), i);
    drives_.push_back(MakeEmulatedDrive(entry.joints[i], scenario.drive, sensor_seed));
  }
  AddToDrives(scenario.faults);
  power_.resize(drives_.size());
  powered_.resize(drives_.size(), false);
  wire_ = MakeFaultyWire(scenario.faults, entry.id, seed);
}

void EmulatedArm::AddToDrives(const std::vector<FaultConfig>& faults) {
  for (size_t i = 0; i < drives_.size(); ++i) {
    const uint64_t fault_seed = RandomBits(seed_, kFaultStream, static_cast<uint64_t>(id_), i);
    drives_[i] = WithFaults(std::move(drives_[i]), joints_[i], faults, id_, static_cast<int>(i) + 1, start_s_,
                            fault_seed);
  }
}

void EmulatedArm::Add(const FaultConfig& fault) {
  AddToDrives({fault});
  auto wire = MakeFaultyWire({fault}, id_, seed_);
  if (wire && wire_) {
    wire_->Add(fault);
  } else if (wire) {
    wire_ = std::move(wire);
  }
  quiet_until_s_ = clock_s_;
}

JointTruth EmulatedArm::TruthOf(size_t joint) const {
  return {plant_.q_rad[joint], plant_.dq_rad_s[joint]};
}

PlanarPlant::Joints EmulatedArm::Torque() const {
  PlanarPlant::Joints tau_Nm{};
  for (size_t i = 0; i < drives_.size(); ++i) tau_Nm[i] = drives_[i]->Torque(clock_s_);
  return tau_Nm;
}

double EmulatedArm::NextEventClock() const {
  double next_s = disturbance_.NextChange(time_s()) - start_s_;
  for (const auto& drive : drives_) {
    next_s = std::min(next_s, drive->NextTorqueChange(clock_s_));
    next_s = std::min(next_s, drive->NextEvent(clock_s_));
  }
  return wire_ ? std::min(next_s, wire_->NextArrival() - start_s_) : next_s;
}

void EmulatedArm::ReleaseIfReady() {
  if (released_ || diverged_ || time_s() < -kSameInstant_s) return;
  if (!std::all_of(drives_.begin(), drives_.end(), [](const auto& drive) { return drive->ProducesTorque(); }))
    return;
  released_ = true;
  on_s_ = clock_s_;
  plant_.dq_rad_s = start_speed_rad_s_;
  start_speed_rad_s_ = {};  // whoever is let go again stands
}

void EmulatedArm::BrakeIfOff() {
  const bool on =
      std::any_of(drives_.begin(), drives_.end(), [](const auto& drive) { return drive->ProducesTorque(); });
  if (on) on_s_ = clock_s_;
  if (!released_ || clock_s_ - on_s_ < config_.brake_s) return;
  released_ = false;
  plant_.dq_rad_s = {};
}

void EmulatedArm::NotePower() {
  for (size_t i = 0; i < drives_.size(); ++i) {
    const bool on = drives_[i]->ProducesTorque();
    if (on == powered_[i]) continue;
    powered_[i] = on;
    (on ? power_[i].on_s : power_[i].off_s) = time_s();
  }
}

void EmulatedArm::Integrate(double dt_s) {
  PlanarPlant::Joints tau_Nm = tau_Nm_;
  const double d_until_s = disturbance_.NextChange(time_s());
  if (d_until_s != d_until_s_ || std::isinf(d_until_s)) d_Nm_ = disturbance_.At(time_s(), plant_, leader_);
  d_until_s_ = d_until_s;
  for (size_t i = 0; i < drives_.size(); ++i) tau_Nm[i] -= d_Nm_[i];
  const PlanarPlant::Joints q_before_rad = plant_.q_rad;
  plant_.Step(tau_Nm, dt_s);
  const bool sane = std::all_of(plant_.dq_rad_s.begin(), plant_.dq_rad_s.end(),
                                [&](double dq) { return std::abs(dq) <= config_.diverged_rad_s; });
  if (!sane) {
    plant_.q_rad = q_before_rad;
    plant_.dq_rad_s = {};
    diverged_ = true;
    released_ = false;
  }
}

void EmulatedArm::AdvanceTo(double t_s, FrameList* out) {
  ReleaseIfReady();
  const double target_s = t_s - start_s_;
  while (clock_s_ < target_s) {
    if (clock_s_ >= quiet_until_s_) {
      quiet_until_s_ = NextEventClock();
      tau_Nm_ = Torque();
    }
    const double next_s = std::min(quiet_until_s_, target_s);
    const double step_end_s =
        next_s - clock_s_ > config_.step_s + kSameInstant_s ? clock_s_ + config_.step_s : next_s;
    if (released_ && step_end_s - clock_s_ > kSameInstant_s) Integrate(step_end_s - clock_s_);
    clock_s_ = step_end_s;
    if (clock_s_ >= quiet_until_s_) {
      for (size_t i = 0; i < drives_.size(); ++i) drives_[i]->OnTime(clock_s_, TruthOf(i), Outbox(out));
      if (wire_) {
        SendOverWire(out);
        TakeLateFrames(out);
      }
      NotePower();
    }
    BrakeIfOff();
    ReleaseIfReady();
  }
}

void EmulatedArm::OnFrame(double t_s, const CanFrame& frame, FrameList* out) {
  AdvanceTo(t_s, out);
  if (!wire_ || wire_->Passes(time_s(), frame, FaultyWire::Way::kToDrives)) HandOver(frame, out);
  quiet_until_s_ = clock_s_;
}

void EmulatedArm::HandOver(const CanFrame& frame, FrameList* out) {
  for (size_t i = 0; i < drives_.size(); ++i) {
    drives_[i]->OnFrame(clock_s_, frame, TruthOf(i), Outbox(out));
  }
  if (wire_) SendOverWire(out);
  NotePower();
}

void EmulatedArm::SendOverWire(FrameList* out) {
  for (const CanFrame& frame : sent_) {
    if (wire_->Passes(time_s(), frame, FaultyWire::Way::kFromDrives)) out->Push(frame);
  }
  sent_.Clear();
}

void EmulatedArm::TakeLateFrames(FrameList* out) {
  while (const auto late = wire_->TakeArrived(time_s())) {
    if (late->way == FaultyWire::Way::kFromDrives) {
      out->Push(late->frame);
    } else {
      HandOver(late->frame, out);
    }
  }
}

}  // namespace armada
