#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "firmware/app/feedback_consistency.h"
#include "firmware/app/fleet.h"
#include "firmware/app/frozen_feedback.h"
#include "firmware/can/joint_drive.h"
#include "firmware/core/arm_controller.h"

namespace armada {

/// The drives of one arm: samples of all joints at one instant, and what speaks against believing them.
/// Allocates in the constructor only.
class JointSet {
 public:
  JointSet(const FleetConfig& fleet, size_t arm);

  /// One tick of each drive's preparation; true when only enabling is left.
  bool Prepare(int64_t now_ns, FrameList* out);
  /// One tick of the bring-up of those that are not in torque mode; the others are left to CommandTorques.
  void BringUpRest(int64_t now_ns, FrameList* out);
  /// One tick of the bring-up of all, with zero torque once they are enabled.
  void BringUp(int64_t now_ns, FrameList* out);
  bool AllInTorqueMode() const;
  /// A drive that was in torque mode no longer is, or has refused the bring-up.
  bool AnyLeft() const;
  /// What keeps drives from torque mode, for people; empty when all are.
  std::string Explain() const;
  /// Allows a bring-up again.
  void Reset();

  /// From now on only newer samples count.
  void ExpectNewSamples(int64_t now_ns);
  /// Asks for them; not of drives that are being found or enabled. Without it those asked in the last tick
  /// stay so: their samples grow old.
  void RequestSamples(int64_t now_ns, ControllerState state, FrameList* out);
  Reception OnFrame(const CanFrame& frame);
  bool SamplesComplete() const;

  /// q and dq at one instant from samples of slightly different ones, missing ones predicted, with the
  /// instant; what is wrong with them; and whether they can be used. `sent_Nm` is the torque sent last.
  /// A joint whose drive was not asked, for it is being enabled, stands on its brake: its sample may be old.
  void ReadAt(int64_t tick_ns, int64_t epoch_ns, const JointVector& sent_Nm, ArmInput* input);

  /// To those in torque mode.
  void CommandTorques(const JointVector& tau_Nm, FrameList* out);
  void QuickStop(FrameList* out);
  void Disable(FrameList* out);

  int size() const { return static_cast<int>(drives_.size()); }
  /// Frames of a drive that no drive of its kind would send.
  int64_t malformed_frames() const { return malformed_frames_; }

 private:
  bool IsBelievable(size_t joint, const JointSample& sample);

  TimingConfig timing_;
  SupervisorConfig supervisor_;
  std::vector<std::unique_ptr<JointDrive>> drives_;
  std::vector<FrozenFeedback> frozen_;
  std::vector<FeedbackConsistency> consistency_;
  std::vector<JointSample> believed_;  ///< the last one of each joint
  std::vector<bool> was_in_torque_;
  std::vector<bool> prepared_;
  std::vector<bool> asked_;  ///< for a sample, in this tick
  int64_t request_ns_ = 0;
  int64_t first_request_ns_ = 0;
  std::array<uint64_t, kMaxDof> sequence_at_request_{};
  bool nonsense_since_complete_ = false;
  int64_t malformed_frames_ = 0;
  int good_ticks_ = 0;
};

}  // namespace armada
