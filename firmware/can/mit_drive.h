#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "firmware/can/damiao_setup.h"
#include "firmware/can/joint_drive.h"
#include "firmware/can/mit_messages.h"

namespace armada {

/// Master's side of one drive that speaks MIT packed frames, in torque control: profiles kMiniCheetah,
/// kCubeMars, kDamiao.
///
/// The drive answers every frame with its state at that moment, so a sample is asked for by sending the last
/// torque once more. The bring-up goes through phases, with one kind of frame to the drive in each; two
/// answers in a phase prove that its frame arrived, for one may still be due from the phase before:
///   disable, Damiao: registers, zero torque, enable.
/// Before torque mode and after it, torques are sent as zero whatever is asked.
///
/// mini-cheetah and CubeMars never say whether they are enabled, and their time-out can neither be read nor
/// be seen at zero torque: their watchdog stays kUnproved.
class MitDrive final : public JointDrive {
 public:
  explicit MitDrive(const JointDriveConfig& config);

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
  DriveWatchdog watchdog() const override;
  uint32_t error_code() const override;
  const JointSample& sample() const override { return sample_; }
  std::string Explain() const override;

  /// Ticks of the bring-up in which the drive may report a fault before it is held to be one: the frame that
  /// clears it may be lost.

 private:
  enum class Phase {
    kIdle,     ///< before the first BringUp
    kDisable,  ///< switched off, old faults cleared
    kSetup,    ///< Damiao: registers
    kZero,     ///< the stored command made zero
    kReady,    ///< to be switched on
    kEnable,   ///< switched on
    kTorque,
    kEnded,  ///< left, stopped or refused: zero torque only, until Reset()
  };

  void Enter(Phase phase);
  /// Moves on when the drive's answers allow it.
  void Advance();
  void OnReply(const mit::Reply& reply, const CanFrame& frame);
  void PushTorque(uint32_t code, FrameList* out);
  bool is_damiao() const { return config_.profile == DriveProfile::kDamiao; }
  bool faulty() const { return error_code() != 0; }

  JointDriveConfig config_;
  std::string wiring_error_;  ///< why these settings cannot work; empty when they can
  DamiaoSetup setup_;
  Phase phase_ = Phase::kIdle;
  int replies_ = 0;  ///< since the phase began
  int faults_ = 0;   ///< ticks of the bring-up in which the drive reported one
  bool heard_ = false;
  bool refused_ = false;  ///< kEnded because of the drive, not of us
  uint8_t status_ = 0;
  uint32_t torque_code_ = mit::kZeroTorqueCode;  ///< sent last
  std::optional<int64_t> asked_ns_;              ///< tick whose frames the drive answers already
  std::optional<uint32_t> position_code_;
  JointSample sample_;
};

}  // namespace armada
