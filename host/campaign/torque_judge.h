#pragma once

#include <cstdint>
#include <vector>

#include "firmware/can/frame.h"
#include "hil/emulated_arm.h"
#include "host/campaign/violation.h"

namespace armada {

/// Judges what boards command and what drives then do: frames byte by byte, and the power that goes into the
/// joints. Of drives other than ODrives it knows no frames, but that there are some.
class TorqueJudge {
 public:
  TorqueJudge(const ScenarioConfig& trial, Violations* violations);

  void OnFrame(size_t arm, double t_s, const CanFrame& frame);
  void OnMoment(size_t arm, double t_s, const EmulatedArm& bench);

 private:
  struct Joint {
    JointDriveConfig config;
    bool judged;  ///< whether what its drive produces is what it means to
    double last_frame_s = -1e9;
    double silence_max_s;  ///< from a frame to the end of the drive's torque
    bool complained = false;
  };
  struct Arm {
    int id;
    std::vector<Joint> joints;
  };

  std::vector<Arm> arms_;
  Violations* violations_;
};

}  // namespace armada
