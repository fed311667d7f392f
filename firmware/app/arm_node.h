#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "firmware/app/fleet.h"
#include "firmware/can/joint_drive.h"
#include "firmware/core/arm_controller.h"
#include "firmware/link/clock_offset.h"
#include "firmware/link/lcm_endpoint.h"
#include "firmware/link/messages.h"

namespace armada {

/// Why a node went to kFault.
enum class FaultCause {
  kNone,
  kDriveLeftTorque,
  kFeedbackStale,
  kFeedbackNonsense,
  kNonFiniteTorque,
  kBusDown,
  kBusOff,
  kBusRestarted,
  kTransmitStuck,
};

constexpr const char* NameOf(FaultCause cause) {
  switch (cause) {
    case FaultCause::kNone:
      return "none";
    case FaultCause::kDriveLeftTorque:
      return "drive not in torque mode";
    case FaultCause::kFeedbackStale:
      return "feedback stale";
    case FaultCause::kFeedbackNonsense:
      return "feedback makes no sense";
    case FaultCause::kNonFiniteTorque:
      return "torque not finite";
    case FaultCause::kBusDown:
      return "bus down";
    case FaultCause::kBusOff:
      return "bus-off";
    case FaultCause::kBusRestarted:
      return "bus restarted";
    case FaultCause::kTransmitStuck:
      break;
  }
  return "torques not sent";
}

/// One arm's board without its sockets and its clock: CAN frames and LCM messages in, frames and messages
/// out. The process and the simulation run the same object. It allocates in the constructor only. Times are
/// nanoseconds of the board's monotonic clock; the fleet's time 0 is `epoch_ns`.
class ArmNode {
 public:
  ArmNode(const FleetConfig& fleet, size_t index, const ArmInitialState& initial, int64_t epoch_ns);

  /// Before the first tick, once a period: brings the drives into torque mode. True once all are.
  bool BringUp(int64_t now_ns, FrameList* out);
  /// What keeps drives from torque mode, for people; empty when all are.
  std::string ExplainDrives() const;

  /// Each tick, in this order:
  /// 1. publish what neighbours use, the estimate valid at this tick;
  std::span<const uint8_t> EncodeEstimate(int64_t tick_ns, MessageBuffer* buffer);
  /// 2. ask the joints for samples, and take the answers until complete or out of time;
  void RequestSamples(int64_t now_ns, FrameList* out);
  Reception OnFrame(const CanFrame& frame);
  bool SamplesComplete() const;
  /// 3. take what the neighbours sent;
  void OnMessage(const LcmMessage& message);
  /// 4. compute and send torques.
  void Step(int64_t tick_ns, FrameList* out);

  /// What the tick did, for people; the process adds its own timing.
  void FillTelemetry(telemetry_t* telemetry);

  /// Something is wrong: drives go to rest in their own way, and the node is in kFault until it is started
  /// anew. Its estimator goes on: neighbours may need it.
  void Fail(FaultCause cause, FrameList* out);
  /// The end of a run: drives go to rest in their own way.
  void Disable(FrameList* out);

  ControllerState state() const { return state_; }
  FaultCause fault() const { return fault_; }
  int id() const { return id_; }
  const ArmController& controller() const { return controller_; }
  /// Messages dropped: malformed, stale, or of another fleet's shape.
  int64_t rejected_messages() const { return rejected_messages_; }
  /// Frames of a drive that no drive of its kind would send.
  int64_t malformed_frames() const { return malformed_frames_; }

 private:
  /// A node this arm listens to, in any of the topologies.
  struct Source {
    int arm_id = 0;  ///< 0: the leader
    ClockOffset clock;
    int64_t stamp_ns = 0;
    Neighbour neighbour{};
    double leader_age_s = 0.0;  ///< as sent; infinite when the sender knows of no leader
    std::array<double, TopologySchedule::kMaxCount> weight{};  ///< by topology
  };

  void ListenTo(const FleetConfig& fleet, int arm_id, size_t topology, double weight);
  template <class Message>
  bool Take(Source& source, const Message& message, int64_t arrival_ns);
  double AgeOf(const Source& source, int64_t now_ns) const;
  void ReadNeighbours(int64_t tick_ns);
  bool ReadJoints(int64_t tick_ns);

  int id_;
  bool shared_clock_;
  TimingConfig timing_;
  TopologySchedule schedule_;
  int64_t epoch_ns_;
  std::vector<std::unique_ptr<JointDrive>> drives_;
  std::vector<Source> sources_;
  ArmController controller_;
  ControllerState state_ = ControllerState::kInit;
  FaultCause fault_ = FaultCause::kNone;
  ArmInput input_;
  int64_t request_ns_ = 0;
  std::array<uint64_t, kMaxDof> sequence_at_request_{};
  bool nonsense_since_complete_ = false;
  int64_t malformed_frames_ = 0;
  int64_t estimate_sequence_ = 0;
  int64_t telemetry_sequence_ = 0;
  int64_t rejected_messages_ = 0;
};

}  // namespace armada
