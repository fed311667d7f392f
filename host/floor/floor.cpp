#include "host/floor/floor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hil/joint_sensor.h"
#include "hil/random.h"
#include "hil/start_state.h"
#include "hil/tracking_record.h"
#include "host/floor/exact_filter.h"
#include "host/floor/exact_tracking.h"

namespace armada {
namespace {

// An arm starts on the leader this long before the window: many times what the closed loop and the filter
// remember.
constexpr double kSettling_s = 2.0;

// What the filter allows for beside the declared disturbance and sensors: too little to cost anything, but
// enough to keep it listening where nothing is random.
constexpr double kUndeclaredTorque_Nm = 0.001;
constexpr double kUndeclaredPosition_rad = 1e-8;
constexpr double kUndeclaredVelocity_rad_s = 1e-7;

// What is to be expected of the disturbance by one who knows everything but the draws.
DisturbanceConfig Expected(DisturbanceConfig config) {
  if (config.kind == DisturbanceKind::kUniform) config.amplitude_Nm = 0.0;
  return config;
}

// Standard deviation of the disturbance from what is to be expected. The adversary's next push is a sign,
// which is lost where the error's is.
double Unexpected_Nm(const DisturbanceConfig& config) {
  switch (config.kind) {
    case DisturbanceKind::kUniform:
      return config.amplitude_Nm / std::numbers::sqrt3;
    case DisturbanceKind::kAdversarial:
      return config.amplitude_Nm;
    default:
      return 0.0;
  }
}

ExactFilterConfig FilterConfig(const ScenarioConfig& scenario, const ArmEntry& entry) {
  ExactFilterConfig config;
  for (const JointDriveConfig& joint : entry.joints) {
    const double counts = scenario.drive.encoder_counts_per_turn * joint.gear_ratio;
    const double count_rad = counts > 0.0 ? 2.0 * std::numbers::pi / counts : 0.0;
    config.q_deviation_rad.push_back(std::hypot(count_rad / std::sqrt(12.0), kUndeclaredPosition_rad));
    config.dq_deviation_rad_s.push_back(
        std::hypot(scenario.drive.velocity_noise_rad_s, kUndeclaredVelocity_rad_s));
  }
  config.disturbance_Nm = std::hypot(Unexpected_Nm(scenario.disturbance), kUndeclaredTorque_Nm);
  return config;
}

/// One arm from shortly before the window to the run's end.
class ArmRun {
 public:
  ArmRun(const ScenarioConfig& scenario, size_t index, uint64_t seed, const JointVector& posture_rad,
         const LeaderPath& leader);
  ArmFloor Run();

 private:
  double TimeOf(int64_t k) const { return static_cast<double>(k) * period_s_; }
  MovingArm Start(const DisturbanceConfig& disturbance, const JointVector& posture_rad) const;
  JointReadings Read();
  void Tick(int64_t k);

  const ScenarioConfig& scenario_;
  const ArmEntry& entry_;
  const LeaderPath& leader_;
  uint64_t seed_;
  double period_s_;
  int64_t first_tick_;
  ExactTracking tracking_;
  MovingArm truth_;
  ExactFilter filter_;
  DelayedTorques torques_;
  std::vector<JointSensor> sensors_;
  TrackingRecord record_;
};

ArmRun::ArmRun(const ScenarioConfig& scenario, size_t index, uint64_t seed, const JointVector& posture_rad,
               const LeaderPath& leader)
    : scenario_(scenario),
      entry_(scenario.fleet.arms[index]),
      leader_(leader),
      seed_(seed),
      period_s_(scenario.fleet.timing.period_s),
      first_tick_(FloorStartTick(scenario)),
      tracking_(entry_.arm, entry_.control.subtask, leader, period_s_),
      truth_(Start(scenario.disturbance, posture_rad)),
      filter_(FilterConfig(scenario, entry_), Start(Expected(scenario.disturbance), posture_rad)),
      torques_(scenario.drive.latency_s),
      record_(scenario) {
  const EmulatedDriveConfig& drive = scenario.drive;
  for (size_t i = 0; i < entry_.joints.size(); ++i) {
    const uint64_t sensor_seed = RandomBits(seed, kSensorStream, static_cast<uint64_t>(entry_.id), i);
    sensors_.emplace_back(entry_.joints[i], drive.encoder_counts_per_turn, drive.velocity_noise_rad_s,
                          sensor_seed);
  }
}

// On the leader, and as fast.
MovingArm ArmRun::Start(const DisturbanceConfig& disturbance, const JointVector& posture_rad) const {
  const double t_s = TimeOf(first_tick_);
  const Zeta zeta = leader_.At(t_s);
  const JointVector q = ReachFrom(PlanarArm(entry_.arm), posture_rad, zeta.x_m);
  const JointVector dq = tracking_.JointVelocity(q, zeta.v_m_s);
  MovingArm arm{PlanarPlant(entry_.arm), HeldDisturbance(Disturbance(disturbance, seed_, entry_.id), leader_),
                t_s};
  std::copy(q.begin(), q.end(), arm.plant.q_rad.begin());
  std::copy(dq.begin(), dq.end(), arm.plant.dq_rad_s.begin());
  return arm;
}

JointReadings ArmRun::Read() {
  JointReadings readings;
  for (size_t i = 0; i < sensors_.size(); ++i) {
    const JointSensor::Reading motor = sensors_[i].Read({truth_.plant.q_rad[i], truth_.plant.dq_rad_s[i]});
    const JointDriveConfig& joint = entry_.joints[i];
    const double joint_rad_per_turn = joint.direction * 2.0 * std::numbers::pi / joint.gear_ratio;
    readings.q_rad[i] = joint_rad_per_turn * motor.position_turns + joint.offset_rad;
    readings.dq_rad_s[i] = joint_rad_per_turn * motor.velocity_turns_s;
  }
  return readings;
}

void ArmRun::Tick(int64_t k) {
  const double t_s = TimeOf(k);
  const double step_s = scenario_.plant.step_s;

  filter_.Correct(Read());
  MovingArm at_effect = filter_.belief();
  at_effect.AdvanceTo(t_s + torques_.latency_s(), torques_, step_s);
  torques_.Schedule(t_s, tracking_.Torque(at_effect));
  filter_.AdvanceTo(TimeOf(k + 1), torques_, step_s);

  // Sampled as in a run.
  const int samples = std::max(1, static_cast<int>(std::lround(period_s_ / TrackingRecord::kSamplePeriod_s)));
  for (int sample = 1; sample <= samples; ++sample) {
    const double sample_s = t_s + period_s_ * sample / samples;
    truth_.AdvanceTo(sample_s, torques_, step_s);
    const PlanarPlant::Tip tip = truth_.plant.EndEffector();
    const TaskVector target = leader_.At(sample_s).x_m;
    record_.Update(sample_s, std::hypot(tip.x_m[0] - target[0], tip.x_m[1] - target[1]));
  }
}

ArmFloor ArmRun::Run() {
  const int64_t ticks = std::llround(scenario_.seconds / period_s_);
  for (int64_t k = first_tick_; k < ticks; ++k) Tick(k);
  return {entry_.id, entry_.arm.dof, record_.rms_m(), record_.max_m()};
}

double FleetRms_m(const std::vector<ArmFloor>& arms) {
  double squares_m2 = 0.0;
  for (const ArmFloor& arm : arms) squares_m2 += arm.rms_m * arm.rms_m;
  return std::sqrt(squares_m2 / static_cast<double>(arms.size()));
}

}  // namespace

int64_t FloorStartTick(const ScenarioConfig& scenario) {
  const double start_s = std::max(0.0, scenario.window_start_s - kSettling_s);
  return std::llround(start_s / scenario.fleet.timing.period_s);
}

FloorResult Floor(const ScenarioConfig& scenario, uint64_t seed) {
  std::vector<JointVector> postures_rad;
  for (const ArmEntry& entry : scenario.fleet.arms) postures_rad.push_back(BentElbow(PlanarArm(entry.arm)));
  return Floor(scenario, seed, postures_rad);
}

FloorResult Floor(const ScenarioConfig& scenario, uint64_t seed,
                  const std::vector<JointVector>& postures_rad) {
  const LeaderPath leader(scenario.leader);
  FloorResult floor;
  for (size_t i = 0; i < scenario.fleet.arms.size(); ++i) {
    floor.arms.push_back(ArmRun(scenario, i, seed, postures_rad[i], leader).Run());
  }
  floor.fleet_rms_m = FleetRms_m(floor.arms);
  return floor;
}

FloorResult Together(const std::vector<FloorResult>& floors) {
  FloorResult together = floors.front();
  for (size_t i = 0; i < together.arms.size(); ++i) {
    ArmFloor& arm = together.arms[i];
    double squares_m2 = 0.0;
    for (const FloorResult& floor : floors) {
      squares_m2 += floor.arms[i].rms_m * floor.arms[i].rms_m;
      arm.max_m = std::max(arm.max_m, floor.arms[i].max_m);
    }
    arm.rms_m = std::sqrt(squares_m2 / static_cast<double>(floors.size()));
  }
  together.fleet_rms_m = FleetRms_m(together.arms);
  return together;
}

}  // namespace armada
