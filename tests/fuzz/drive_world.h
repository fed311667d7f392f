#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "firmware/can/make_drive.h"
#include "tests/fuzz/byte_source.h"
#include "tests/fuzz/drive_actions.h"

namespace armada {

/// One master and one emulated drive on a bus, in virtual time, with whatever else an input puts there. Every
/// step states what must hold (Require).
class DriveWorld {
 public:
  explicit DriveWorld(const DriveSetup& setup);

  void Act(DriveAction action, ByteSource* input);

  /// Ticks of an undisturbed bring-up of a new drive until torque mode, which must come.
  void Recover();
  void TorqueTick(double tau_Nm);
  void Pass(double dt_s);

  int64_t now_ns() const;
  /// What the drive put on the bus, last; oldest first.
  const std::vector<CanFrame>& from_drive() const { return from_drive_; }
  const std::vector<CanMessage>& messages() const { return messages_; }

 private:
  CanFrame ReadMessage(ByteSource* input) const;
  CanFrame ReadReplay(ByteSource* input) const;
  double ReadTorque(ByteSource* input) const;

  void BringUpTick();
  void PowerCycle();
  /// Lets the master append frames, checks them and puts them on the bus; how many they were.
  template <class Call>
  size_t Master(Call call);
  void CheckFromMaster(const CanFrame& frame, bool torque_mode) const;
  /// A frame of neither master nor drive: both hear it.
  void Inject(CanFrame frame);
  void ToDrive(const CanFrame& frame);
  void ToMaster(CanFrame frame);
  void Deliver(const FrameList& answers);
  bool Lost();
  void CheckMaster();
  void CheckDrive() const;

  JointDriveConfig joint_;
  EmulatedDriveConfig drive_config_;
  std::vector<CanMessage> messages_;
  std::unique_ptr<JointDrive> master_;
  std::unique_ptr<EmulatedDrive> drive_;
  JointTruth truth_;
  double t_s_ = 0.0;  ///< since the drive's power-up
  int64_t power_up_ns_ = 0;
  uint8_t to_lose_ = 0;
  bool was_in_torque_ = false;
  bool ended_ = false;  ///< left torque mode or was stopped, not reset since
  uint64_t samples_ = 0;
  std::vector<CanFrame> from_drive_;
};

}  // namespace armada
