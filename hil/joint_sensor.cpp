#include "hil/joint_sensor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace armada {
namespace {

/// Standard normal, near enough for noise and the same bits on every machine: the sum of twelve uniform
/// 16-bit numbers has mean 6 (2^16 - 1), variance 2^32 - 1 and no use for a mathematics library. It ends at
/// six standard deviations.
double StandardNormal(std::mt19937_64* random) {
  uint64_t sum = 0;
  for (int word = 0; word < 3; ++word) {
    const uint64_t bits = (*random)();
    sum += (bits & 0xFFFF) + (bits >> 16 & 0xFFFF) + (bits >> 32 & 0xFFFF) + (bits >> 48);
  }
  return (static_cast<double>(sum) - 6.0 * 0xFFFF) / 0x10000;
}

}  // namespace

JointSensor::JointSensor(const JointDriveConfig& joint, double counts_per_turn, double velocity_noise_rad_s,
                         uint64_t seed)
    : offset_rad_(joint.offset_rad),
      turns_per_rad_(joint.direction * joint.gear_ratio / (2.0 * std::numbers::pi)),
      counts_per_turn_(counts_per_turn),
      velocity_noise_rad_s_(velocity_noise_rad_s),
      random_(seed) {}

JointSensor::Reading JointSensor::Read(const JointTruth& truth) {
  double position_turns = turns_per_rad_ * (truth.position_rad - offset_rad_);
  if (counts_per_turn_ > 0.0) {
    position_turns = std::floor(position_turns * counts_per_turn_ + 0.5) / counts_per_turn_;
  }
  double velocity_rad_s = truth.velocity_rad_s;
  if (velocity_noise_rad_s_ > 0.0) velocity_rad_s += velocity_noise_rad_s_ * StandardNormal(&random_);
  return {position_turns, turns_per_rad_ * velocity_rad_s};
}

double JointTorque(const JointDriveConfig& joint, double motor_Nm) {
  const double wanted_Nm = joint.direction * joint.gear_ratio * motor_Nm;
  return std::clamp(wanted_Nm, -joint.torque_limit_Nm, joint.torque_limit_Nm);
}

}  // namespace armada
