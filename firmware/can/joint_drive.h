#pragma once

#include <cstdint>

#include "firmware/can/frame_list.h"

namespace armada {

/// How a joint is wired to its drive. The codec converts; everything above it speaks joint-side SI units.
struct JointDriveConfig {
  int node_id = 0;               ///< drive's address on its bus
  double gear_ratio = 1.0;       ///< motor turns per joint turn, > 0
  double direction = 1.0;        ///< +1 or -1: sign of motor motion for positive joint motion
  double offset_rad = 0.0;       ///< joint angle at the drive's zero
  double torque_limit_Nm = 0.0;  ///< joint-side; the codec never encodes more

  template <class Visitor>
  void Visit(Visitor& parameter) {
    parameter({"node_id", "", 0, 63, "address of the drive on the arm's bus"}, node_id);
    parameter({"gear_ratio", "", 1e-3, 1e4, "motor turns per joint turn"}, gear_ratio);
    parameter({"direction", "", -1, 1, "+1 or -1, sign of motor motion for positive joint motion"},
              direction);
    parameter({"offset_rad", "rad", -1e3, 1e3, "joint angle at the drive's zero"}, offset_rad);
    parameter({"torque_limit_Nm", "N m", 1e-3, 1e5, "largest torque at the joint"}, torque_limit_Nm);
  }
};

enum class DriveState {
  kUnknown,   ///< never heard of
  kIdle,      ///< alive, not enabled by us; an error from before the bring-up shows in error_code() only
  kEnabling,  ///< bring-up frames sent, not yet confirmed
  kTorque,    ///< closed loop, follows torque commands
  kFault,     ///< enabled by us, the drive reports an error; it produces no torque
};

/// One sample of a joint, at the time of its frame.
struct JointSample {
  double position_rad = 0.0;
  double velocity_rad_s = 0.0;
  int64_t stamp_ns = 0;   ///< reception time of the frame
  uint64_t sequence = 0;  ///< counts samples; 0 = none yet
};

/// The master's side of one joint's drive: bytes <-> joint state and torque. No I/O: it consumes frames and
/// appends the frames it wants sent to `out`. One implementation a drive family.
class JointDrive {
 public:
  virtual ~JointDrive() = default;

  /// Appends the frames of the next step of the bring-up (clear errors, torque mode, zero torque, closed
  /// loop). Call once a tick until `state() == kTorque`. Does nothing once there, nothing in kFault, and
  /// nothing ever again on a drive that was there and left it, or was disabled: a drive does not re-arm by
  /// itself.
  virtual void Enable(FrameList* out) = 0;

  /// Asks for a fresh sample of position and velocity.
  virtual void RequestSample(FrameList* out) = 0;

  /// Joint-side torque; clipped to the configured limit. A non-finite value is encoded as zero.
  virtual void CommandTorque(double tau_Nm, FrameList* out) = 0;

  /// Makes the drive stop producing torque, in the drive's own way.
  virtual void Disable(FrameList* out) = 0;

  /// Takes a frame of the bus; true when it was this drive's and well formed.
  virtual bool OnFrame(const CanFrame& frame) = 0;

  virtual DriveState state() const = 0;
  virtual uint32_t error_code() const = 0;  ///< the drive's own code; 0 = none
  virtual const JointSample& sample() const = 0;
};

}  // namespace armada
