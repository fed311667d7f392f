#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "hil/disturbance.h"
#include "hil/emulated_drive.h"
#include "hil/faulty_wire.h"
#include "hil/start_state.h"

namespace armada {

/// When a drive's power stage last came on and went off; never: none.
struct DrivePower {
  std::optional<double> on_s;
  std::optional<double> off_s;
};

/// One arm on its bench: plant, drives and disturbance, in virtual or in real time. Until t = 0 and until
/// every drive is in torque mode the joints stand on their brakes at the start position; then the plant is
/// let go with the start speed. With every drive off for plant.brake_s the brakes close again. Faults of its
/// drives and of its bus are the scenario's.
class EmulatedArm {
 public:
  /// The bench is switched on at `start_s` <= 0. `leader` (may be null) is needed by adversarial
  /// disturbances.
  EmulatedArm(const ScenarioConfig& scenario, size_t index, uint64_t seed, const ArmStart& start,
              const LeaderPath* leader, double start_s);

  /// Moves time on to `t_s`; frames that the drives send by themselves are appended to `out`.
  void AdvanceTo(double t_s, FrameList* out);
  /// From now on there is this fault, too, of a drive or of the bus. Allocates.
  void Add(const FaultConfig& fault);
  /// A frame on the arm's bus at `t_s`; answers are appended.
  void OnFrame(double t_s, const CanFrame& frame, FrameList* out);

  const PlanarPlant& plant() const { return plant_; }
  double time_s() const { return clock_s_ + start_s_; }
  /// Torque that the drives produce now, N m.
  PlanarPlant::Joints Torque() const;
  /// The joints' speed left every bound; the plant is frozen where it was.
  bool diverged() const { return diverged_; }
  bool released() const { return released_; }
  /// Whether a joint's drive has its power stage on.
  bool IsOn(size_t joint) const { return drives_[joint]->ProducesTorque(); }
  /// Of each drive, in the order of the joints.
  const std::vector<DrivePower>& power() const { return power_; }

 private:
  void AddToDrives(const std::vector<FaultConfig>& faults);
  JointTruth TruthOf(size_t joint) const;
  /// The frame reaches the drives.
  void HandOver(const CanFrame& frame, FrameList* out);
  /// Where the drives put what they send.
  FrameList* Outbox(FrameList* out) { return wire_ ? &sent_ : out; }
  /// What the drives have sent goes over a wire with faults.
  void SendOverWire(FrameList* out);
  void TakeLateFrames(FrameList* out);
  double NextEventClock() const;
  void ReleaseIfReady();
  void BrakeIfOff();
  /// After each moment at which a drive may have gone on or off.
  void NotePower();
  void Integrate(double dt_s);

  int id_;
  std::vector<JointDriveConfig> joints_;
  uint64_t seed_;
  PlantConfig config_;
  PlanarPlant plant_;
  Disturbance disturbance_;
  const LeaderPath* leader_;
  std::vector<std::unique_ptr<EmulatedDrive>> drives_;
  std::vector<DrivePower> power_;
  std::vector<bool> powered_;
  std::optional<FaultyWire> wire_;  ///< without a fault there is none between board and drives
  FrameList sent_;
  PlanarPlant::Joints start_speed_rad_s_;
  PlanarPlant::Joints d_Nm_{};
  double d_until_s_ = 0.0;  ///< end of the interval that d_Nm_ is held for
  double start_s_;
  double clock_s_ = 0.0;  ///< since the bench was switched on: the drives' time
  double quiet_until_s_ =
      0.0;  ///< on that clock: until then drives and disturbance do nothing and change nothing
  PlanarPlant::Joints tau_Nm_{};  ///< torque of the drives until then
  double on_s_ = 0.0;             ///< when a drive was on last
  bool released_ = false;
  bool diverged_ = false;
};

}  // namespace armada
