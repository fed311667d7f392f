#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware/app/fleet.h"
#include "firmware/app/frozen_feedback.h"
#include "firmware/can/joint_drive.h"
#include "firmware/core/arm_controller.h"
#include "firmware/link/channels.h"
#include "firmware/link/clock_offset.h"
#include "firmware/link/lcm_message.h"
#include "firmware/link/messages.h"
#include "firmware/link/seal.h"

namespace armada {

/// Why a node went to kFault.
enum class FaultCause {
  kNone,
  kDriveLeftTorque,
  kFeedbackStale,
  kFeedbackNonsense,
  kFeedbackFrozen,
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
    case FaultCause::kFeedbackFrozen:
      return "feedback frozen";
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

/// Messages of nodes that this one listens to, and that were dropped.
struct RejectedMessages {
  int64_t malformed = 0;    ///< no message of this type, or of another task
  int64_t forged = 0;       ///< without the sender's seal, in a fleet with a key
  int64_t replayed = 0;     ///< sealed, but not newer than the last one of the sender
  int64_t stale = 0;        ///< sequence or stamp not newer than the last one of the sender
  int64_t late = 0;         ///< older than link.age_max_s when it came
  int64_t implausible = 0;  ///< a state that cannot follow the sender's last one

  int64_t total() const { return malformed + forged + replayed + stale + late + implausible; }
};

/// One arm's board without its sockets and its clock: CAN frames and LCM messages in, frames and messages
/// out. The process and the simulation run the same object. It allocates in the constructor only. Times are
/// nanoseconds of the board's monotonic clock; the fleet's time 0 is `epoch_ns`.
class ArmNode {
 public:
  /// With an identity every message is sealed, and none is believed without its sender's seal.
  ArmNode(const FleetConfig& fleet, size_t index, const ArmInitialState& initial, int64_t epoch_ns,
          const std::optional<LinkIdentity>& identity = std::nullopt);

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
  std::span<const uint8_t> EncodeTelemetry(const telemetry_t& telemetry, MessageBuffer* buffer);

  /// Something is wrong: drives go to rest in their own way, and the node is in kFault until it is started
  /// anew. Its estimator goes on: neighbours may need it.
  void Fail(FaultCause cause, FrameList* out);
  /// The end of a run: drives go to rest in their own way.
  void Disable(FrameList* out);

  ControllerState state() const { return state_; }
  FaultCause fault() const { return fault_; }
  int id() const { return id_; }
  std::string_view estimate_channel() const { return estimate_channel_; }
  std::string_view telemetry_channel() const { return telemetry_channel_; }
  const ArmController& controller() const { return controller_; }
  const RejectedMessages& rejected_messages() const { return rejected_messages_; }
  /// Frames of a drive that no drive of its kind would send.
  int64_t malformed_frames() const { return malformed_frames_; }

 private:
  /// A node this arm listens to, in any of the topologies.
  struct Source {
    int arm_id = 0;  ///< 0: the leader
    std::optional<SealCheck> seal;
    ClockOffset clock;
    int64_t stamp_ns = 0;
    Neighbour neighbour{};
    double leader_age_s = 0.0;  ///< as sent; infinite when the sender knows of no leader
    std::array<double, TopologySchedule::kMaxCount> weight{};  ///< by topology
  };

  void ListenTo(const FleetConfig& fleet, int arm_id, size_t topology, double weight,
                const std::optional<LinkIdentity>& identity);
  static bool Hears(const Source& source, std::string_view channel);
  /// Without its seal, if it is genuine; counts it otherwise.
  bool Unseal(Source& source, std::string_view channel, std::span<const uint8_t>* message);
  template <class Message>
  bool Take(Source& source, const Message& message, int64_t arrival_ns);
  bool IsPlausible(const Source& source, const Zeta& zeta, int64_t stamp_ns) const;
  bool TakeLeader(Source& source, const LcmMessage& message);
  bool TakeEstimate(Source& source, const LcmMessage& message);
  double AgeOf(const Source& source, int64_t stamp_ns, int64_t now_ns) const;
  void ReadNeighbours(int64_t tick_ns);
  FaultCause ReadJoints(int64_t tick_ns);

  int id_;
  ArmChannel estimate_channel_;
  ArmChannel telemetry_channel_;
  LcmLinkConfig link_;
  EstimatorConfig estimator_;
  TimingConfig timing_;
  TopologySchedule schedule_;
  int64_t epoch_ns_;
  std::vector<std::unique_ptr<JointDrive>> drives_;
  std::vector<Source> sources_;
  std::optional<Sealer> sealer_;
  ArmController controller_;
  ControllerState state_ = ControllerState::kInit;
  FaultCause fault_ = FaultCause::kNone;
  ArmInput input_;
  int64_t request_ns_ = 0;
  std::array<uint64_t, kMaxDof> sequence_at_request_{};
  std::vector<FrozenFeedback> frozen_;
  bool nonsense_since_complete_ = false;
  int64_t malformed_frames_ = 0;
  int64_t estimate_sequence_ = 0;
  int64_t telemetry_sequence_ = 0;
  RejectedMessages rejected_messages_;
};

}  // namespace armada
