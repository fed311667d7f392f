#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/can/can_filter.h"
#include "firmware/can/frame_list.h"
#include "firmware/can/joint_drive_config.h"

namespace armada {

enum class DriveState {
  kUnknown,   ///< never heard of
  kIdle,      ///< alive, not enabled by us; an error from before the bring-up shows in error_code() only
  kEnabling,  ///< being configured, proved and enabled
  kTorque,    ///< closed loop, follows torque commands
  kFault,     ///< refused, or enabled by us and in error since; it produces no torque
};

/// Whether the drive stops by itself when its master falls silent.
enum class DriveWatchdog {
  kUnproved,  ///< not known yet, or the protocol has no way to tell
  kProved,    ///< it tripped when it should, or its time was written and read back
  kOff,       ///< it did not trip: the drive is refused
};

/// What a frame was to a drive.
enum class Reception {
  kNotMine,    ///< of somebody else, or a kind that this side has no use for
  kTaken,      ///< this drive's, and well formed
  kMalformed,  ///< this drive's by its identifier, but no such message can be: ignored, to be counted
};

/// One sample of a joint, at the time of its frame.
struct JointSample {
  double position_rad = 0.0;
  double velocity_rad_s = 0.0;
  int64_t stamp_ns = 0;   ///< reception time of the frame
  uint64_t sequence = 0;  ///< counts samples; 0 = none yet
};

/// The master's side of one joint's drive: bytes <-> joint state and torque. No I/O and no clock: it consumes
/// frames and appends the frames it wants sent to `out`. One implementation a drive family. Times are
/// CLOCK_MONOTONIC. Nothing allocates but the constructor, Filters and Explain.
class JointDrive {
 public:
  virtual ~JointDrive() = default;

  /// One tick of what the bring-up does with the power stage off: finds the drive, switches off what an
  /// earlier master has left on, and configures it. True when only enabling is left. Until then the drive is
  /// not asked for samples: any frame may feed the watchdog of a drive that still holds a torque. Call once a
  /// control period, instead of BringUp, for as long as the drive is not to be enabled.
  virtual bool Prepare(int64_t now_ns, FrameList* out) = 0;

  /// One tick of the bring-up: finds the drive, configures it and reads that back, has it prove its watchdog,
  /// enables it with zero torque, and from then on keeps it fed. Call once a control period until the first
  /// torque. Does nothing in kFault, and nothing ever again on a drive that was in torque mode and left it,
  /// or was stopped: a drive does not re-arm by itself.
  virtual void BringUp(int64_t now_ns, FrameList* out) = 0;

  /// Asks for a fresh sample of position and velocity. Once a control period, before the torque;
  /// not during the bring-up, in which a drive may have to be left alone.
  virtual void RequestSample(int64_t now_ns, FrameList* out) = 0;

  /// Joint-side torque; clipped to the configured limit. A non-finite value is encoded as zero. Its frame is
  /// `latest_only`.
  virtual void CommandTorque(double tau_Nm, FrameList* out) = 0;

  /// Makes the drive come to rest as fast as it can under its own control, then without torque; where the
  /// protocol has no such thing, at once without torque.
  virtual void QuickStop(FrameList* out) = 0;

  /// Makes the drive stop producing torque, in the drive's own way.
  virtual void Disable(FrameList* out) = 0;

  /// Takes a frame of the bus.
  virtual Reception OnFrame(const CanFrame& frame) = 0;

  /// Frames that this drive and its master put on the bus; all others need not be received.
  virtual std::vector<CanFilter> Filters() const = 0;

  /// Allows a bring-up again after the drive has left torque mode, was stopped, or is in kFault. The decision
  /// of a person or of a supervisor, never of a codec.
  virtual void Reset() = 0;

  virtual DriveState state() const = 0;
  virtual DriveWatchdog watchdog() const = 0;
  virtual uint32_t error_code() const = 0;  ///< the drive's own code; 0 = none
  virtual const JointSample& sample() const = 0;

  /// What keeps the drive from torque mode, for people: one clause, empty when nothing does.
  virtual std::string Explain() const = 0;
};

}  // namespace armada
