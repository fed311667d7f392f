#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "firmware/can/joint_drive.h"
#include "firmware/can/moteus_messages.h"

namespace armada {

/// Master's side of one moteus controller in torque control: position mode without a position and without
/// gains, so that the feed-forward torque is all there is. Every torque carries the time for which it is
/// valid; after that the controller damps the joint (mode 11) until it is stopped. The bring-up stops the
/// controller, arms it with zero torque, and reads the watchdog's time back.
///
/// A query does not feed the watchdog, a torque is not answered. Any torque arms a stopped controller:
/// CommandTorque therefore sends nothing before torque mode and after it.
class MoteusDrive final : public JointDrive {
 public:
  explicit MoteusDrive(const JointDriveConfig& config);

  bool Prepare(int64_t now_ns, FrameList* out) override;
  void BringUp(int64_t now_ns, FrameList* out) override;
  void RequestSample(int64_t now_ns, FrameList* out) override;
  void CommandTorque(double tau_Nm, FrameList* out) override;
  void QuickStop(FrameList* out) override;
  void Disable(FrameList* out) override;
  Reception OnFrame(const CanFrame& frame) override;
  std::vector<CanFilter> Filters() const override;
  void Reset() override;

  DriveState state() const override;
  DriveWatchdog watchdog() const override { return watchdog_; }
  /// Register 0x00F in mode 1 (fault); 11 in mode 11 (the watchdog has tripped), which has no fault code.
  uint32_t error_code() const override;
  const JointSample& sample() const override { return sample_; }
  std::string Explain() const override;

  /// Attempts to arm that may end in a fault or a time-out before the drive is held to be faulty.

 private:
  enum class Phase {
    kIdle,  ///< before the first BringUp
    kStop,  ///< to be stopped, which clears old faults
    kArm,   ///< fed with zero torque, until it follows
    kTorque,
    kEnded,  ///< left, stopped or refused: queries only, until Reset()
  };
  enum class Refusal { kNone, kFault, kRegisterMap, kWatchdog };

  void OnState(const moteus::State& state, const CanFrame& frame);
  void OnSetup(const moteus::Setup& setup);
  void End(Refusal refusal);
  void PushTorque(double motor_Nm, FrameList* out);

  JointDriveConfig config_;
  Phase phase_ = Phase::kIdle;
  Refusal refusal_ = Refusal::kNone;
  DriveWatchdog watchdog_ = DriveWatchdog::kUnproved;
  int attempts_ = 0;
  bool heard_ = false;
  moteus::State state_;
  int32_t register_map_ = 0;
  float watchdog_s_ = 0.0f;          ///< read back
  std::optional<int64_t> asked_ns_;  ///< tick in which the bring-up has asked for a sample
  JointSample sample_;
};

}  // namespace armada
