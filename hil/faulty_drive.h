#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "hil/emulated_drive.h"
#include "hil/fault.h"
#include "hil/faulty_signal.h"
#include "hil/faulty_status.h"

namespace armada {

/// A drive with faults, around one that knows of none: it senses another joint than there is, tells another
/// state than it is in, produces another torque than it means to, or fails. Where faults of one signal
/// overlap, each makes something of what the one before has left. Allocates in the constructor only.
class FaultyDrive final : public EmulatedDrive {
 public:
  /// `faults` of this joint, of kind kDrive or kDriveError; `start_s`: the run's time at the drive's
  /// power-up.
  FaultyDrive(std::unique_ptr<EmulatedDrive> drive, const JointDriveConfig& joint,
              const std::vector<FaultConfig>& faults, double start_s, uint64_t seed);

  void OnFrame(double t_s, const CanFrame& frame, const JointTruth& truth, FrameList* out) override;
  void OnTime(double t_s, const JointTruth& truth, FrameList* out) override;
  double Torque(double t_s) const override;
  double NextTorqueChange(double t_s) const override;
  double NextEvent(double t_s) const override;
  bool ProducesTorque() const override { return drive_->ProducesTorque(); }
  void Fail(double t_s, FrameList* out) override { drive_->Fail(t_s, out); }

 private:
  /// One fault, in the drive's time.
  struct Fault {
    FaultConfig config;
    std::optional<FaultySignal> signal;  ///< of a position, a velocity or a current
    std::optional<FaultyStatus> status;  ///< of a status
    bool holds = false;
    bool done = false;

    /// When the fault next begins, changes or ends by itself.
    double due_s() const;
  };

  /// Faults begin and end, and what the drive senses follows.
  void Update(double t_s, const JointTruth& truth);
  /// What the drive does now, after it has done what it does by itself.
  void Finish(double t_s, FrameList* out);

  std::unique_ptr<EmulatedDrive> drive_;
  std::vector<Fault> faults_;
  JointTruth sensed_;
  FrameList sent_;  ///< by the drive, on its way to the bus
};

/// The drive itself when none of the scenario's faults is its, so that a run without faults is what it was.
/// `joint_number` counts from 1.
std::unique_ptr<EmulatedDrive> WithFaults(std::unique_ptr<EmulatedDrive> drive, const JointDriveConfig& joint,
                                          const std::vector<FaultConfig>& faults, int arm_id,
                                          int joint_number, double start_s, uint64_t seed);

}  // namespace armada
