#include "host/campaign/torque_judge.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace armada {
namespace {

// ODrive's CAN protocol: the address stands above five bits of command.
constexpr uint32_t kCommandBits = 5;
constexpr uint32_t kSetInputTorque = 0x0E;

// What the emulation's grid of time adds, and rounding the motor's torque to a float.
constexpr double kGrid_s = 0.002;
constexpr double kRounding = 1.0 + 1e-6;
// Power that drives no arm: what a drive's own stop puts into a joint that it holds at rest.
constexpr double kNoPower_W = 0.1;

bool IsODrive(DriveProfile profile) {
  return profile == DriveProfile::kODriveCanSimple || profile == DriveProfile::kODriveCanSimpleV05;
}

float FloatAt(const CanFrame& frame) {
  uint32_t bits = 0;
  for (size_t i = 4; i-- > 0;) bits = bits << 8 | frame.data[i];
  return std::bit_cast<float>(bits);
}

/// Nobody can answer for a drive that produces what it does not mean to.
bool LiesOfTorque(const std::vector<FaultConfig>& faults, int arm_id, int joint_number) {
  return std::any_of(faults.begin(), faults.end(), [&](const FaultConfig& fault) {
    return fault.signal == FaultSignal::kCurrent && fault.arm == arm_id &&
           (fault.joint == 0 || fault.joint == joint_number);
  });
}

/// Frames that are late on the wire keep a drive's watchdog fed for so much longer.
double LatestFrame_s(const std::vector<FaultConfig>& faults, int arm_id) {
  double late_s = 0.0;
  for (const FaultConfig& fault : faults) {
    if (fault.arm == arm_id && fault.kind == FaultKind::kBusDelay) late_s += fault.value;
  }
  return late_s;
}

}  // namespace

TorqueJudge::TorqueJudge(const ScenarioConfig& trial, Violations* violations) : violations_(violations) {
  for (const ArmEntry& entry : trial.fleet.arms) {
    Arm arm{entry.id, {}};
    for (const JointDriveConfig& drive : entry.joints) {
      const int number = static_cast<int>(arm.joints.size()) + 1;
      arm.joints.push_back({.config = drive,
                            .judged = !LiesOfTorque(trial.faults, entry.id, number),
                            .silence_max_s = drive.watchdog_s + trial.drive.latency_s + kGrid_s +
                                             LatestFrame_s(trial.faults, entry.id)});
    }
    arms_.push_back(arm);
  }
}

void TorqueJudge::OnFrame(size_t arm, double t_s, const CanFrame& frame) {
  for (size_t i = 0; i < arms_[arm].joints.size(); ++i) {
    Joint& joint = arms_[arm].joints[i];
    const bool odrive = IsODrive(joint.config.profile);
    if (odrive && (frame.extended || frame.id >> kCommandBits != static_cast<uint32_t>(joint.config.node_id)))
      continue;
    joint.last_frame_s = t_s;
    if (!odrive || frame.remote || (frame.id & ((1u << kCommandBits) - 1)) != kSetInputTorque) continue;
    const auto torque_Nm = static_cast<double>(FloatAt(frame)) * joint.config.gear_ratio;
    const bool fits = frame.length >= 4 && std::isfinite(torque_Nm) &&
                      std::abs(torque_Nm) <= joint.config.torque_limit_Nm * kRounding;
    if (fits) continue;
    violations_->push_back(
        {Invariant::kTorqueInLimits, t_s, arms_[arm].id,
         "joint " + std::to_string(i + 1) + " is told " + std::to_string(torque_Nm) + " N m"});
  }
}

void TorqueJudge::OnMoment(size_t arm, double t_s, const EmulatedArm& bench) {
  const PlanarPlant::Joints torque_Nm = bench.Torque();
  for (size_t i = 0; i < arms_[arm].joints.size(); ++i) {
    Joint& joint = arms_[arm].joints[i];
    const double silence_s = t_s - joint.last_frame_s;
    const double power_W = torque_Nm[i] * bench.plant().dq_rad_s[i];
    const bool drives = joint.judged && silence_s > joint.silence_max_s && power_W > kNoPower_W;
    if (drives && !joint.complained) {
      violations_->push_back({Invariant::kDriveStops, t_s, arms_[arm].id,
                              "joint " + std::to_string(i + 1) + " is driven with " +
                                  std::to_string(power_W) + " W, " + std::to_string(silence_s) +
                                  " s after its last frame"});
    }
    joint.complained = drives;
  }
}

}  // namespace armada
